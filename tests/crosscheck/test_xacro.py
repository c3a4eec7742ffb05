"""Robots written in xacro, expanded by truecut and by the reference program (`xacro` of PyPI), element by element.

Three kinds: robots of this repository that use what the language offers, expressions drawn at random, and the
published arms in the folder that `TRUECUT_ROBOTS` names (skipped where it is not set).
"""

import os
import pathlib
import random
import re
import xml.etree.ElementTree as ElementTree

import pytest
import xacro
import xacro.substitution_args

HERE = pathlib.Path(__file__).resolve().parent / "xacro"
PUBLISHED = os.environ.get("TRUECUT_ROBOTS")
SEED = 24
EXPRESSIONS = 400


def published(ending=".xacro"):
    """Files that are robots themselves: those that only define macros come to no link."""
    if not PUBLISHED:
        return []
    files = sorted(pathlib.Path(PUBLISHED).glob(f"*/urdf/*{ending}"))
    return [file for file in files if "_macro" not in file.name and "common_" not in file.name]


def reference(file, arguments=None, packages=HERE):
    """The root element as the reference program expands it; packages lie beside each other."""
    xacro.substitution_args._eval_find = lambda name: str(pathlib.Path(packages) / name)
    text = xacro.process_file(str(file), mappings=dict(arguments or {})).toxml()
    return ElementTree.fromstring(text)


def ours(truecut, file, arguments=None, further=()):
    given = [word for name, value in (arguments or {}).items() for word in ("--arg", f"{name}={value}")]
    return ElementTree.fromstring(truecut.call("robot", file, "--urdf-text", *given, *further))


def local(name):
    return name.rsplit("}", maxsplit=1)[-1]


def assert_same_word(one, other, place):
    if one == other:
        return
    try:
        assert float(one) == float(other), place
    except ValueError:
        raise AssertionError(f"{place}: {one!r} is not {other!r}") from None


def assert_same(one, other, place=""):
    """Same name, attributes, text and children; numbers are compared as numbers, to the last bit."""
    place = f"{place}/{local(other.tag)}[{other.get('name', '')}]"
    assert local(one.tag) == local(other.tag), place
    assert {local(key) for key in one.attrib} == {local(key) for key in other.attrib}, place
    theirs = {local(key): value for key, value in other.attrib.items()}
    for key, value in one.attrib.items():
        words, other_words = value.split(), theirs[local(key)].split()
        assert len(words) == len(other_words), f"{place} {key}: {value!r}, {theirs[local(key)]!r}"
        for word, other_word in zip(words, other_words):
            assert_same_word(word, other_word, f"{place} {key}")
    assert (one.text or "").split() == (other.text or "").split(), place
    assert len(one) == len(other), place
    for child, other_child in zip(one, other):
        assert_same(child, other_child, place)


@pytest.mark.parametrize("arguments", [{}, {"joints": "2"}, {"with_gripper": "false"}], ids=str)
def test_crosscheck_xacro_own_robot(truecut, arguments):
    file = HERE / "slide_arm_description/urdf/slide_arm.xacro"
    assert_same(ours(truecut, file, arguments), reference(file, arguments))


def number(rng):
    return rng.choice([str(rng.randint(0, 9)), f"{rng.uniform(0.1, 5):.3f}", "a", "b", "pi"])


def expression(rng, depth):
    """A random expression that has a value: divisors are above zero, powers small."""
    if depth == 0:
        return number(rng)
    inner = lambda: expression(rng, depth - 1)
    return rng.choice(
        [
            lambda: f"({inner()} {rng.choice('+-*')} {inner()})",
            lambda: f"{inner()} {rng.choice(['/', '//', '%'])} (fabs({inner()}) + 0.5)",
            lambda: f"-{number(rng)} {rng.choice(['//', '%'])} {rng.randint(1, 5)}",
            lambda: f"(fabs({number(rng)}) + 1)**{rng.randint(0, 3)}",
            lambda: f"-{number(rng)}**2",
            lambda: f"{rng.choice(['sin', 'cos', 'atan', 'radians', 'degrees', 'floor', 'ceil', 'round'])}({number(rng)})",
            lambda: f"{rng.choice(['min', 'max'])}({inner()}, {inner()})",
            lambda: f"atan2({number(rng)}, {number(rng)})",
            lambda: f"({inner()} if {number(rng)} {rng.choice(['<', '>=', '==', '!='])} {number(rng)} else {inner()})",
            lambda: f"({number(rng)} < {number(rng)} <= {number(rng)} or not {number(rng)} > {number(rng)})",
            lambda: f"[{inner()}, {inner()}][{rng.choice([0, 1, -1])}]",
            lambda: f"int({inner()})",
        ]
    )()


def text_expression(rng):
    """A random expression whose value is a text or a truth value."""
    word = f"(('x' + str({number(rng)}) + 'y')*{rng.randint(1, 2)})"
    return rng.choice([word, f"{word}[{rng.randint(-2, 2)}]", f"'{rng.choice('xyz')}' in {word}", f"len({word}) > 4"])


def test_crosscheck_xacro_random_expressions(truecut, tmp_path):
    rng = random.Random(SEED)
    texts = [expression(rng, rng.randint(1, 3)) if k % 8 else text_expression(rng) for k in range(EXPRESSIONS)]
    escaped = [text.replace("<", "&lt;") for text in texts]
    values = "\n".join(f'<value name="{i}" is="${{{text}}}"/>' for i, text in enumerate(escaped))
    file = tmp_path / "values.xacro"
    file.write_text(
        '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="values">\n'
        '<xacro:property name="a" value="3"/><xacro:property name="b" value="${a/7}"/>\n'
        f"{values}\n</robot>\n"
    )
    mine, theirs = ours(truecut, file), reference(file)
    assert len(mine) == len(theirs) == EXPRESSIONS
    for one, other, text in zip(mine, theirs, texts):
        left, right = one.get("is"), other.get("is")
        try:
            # Sines and powers may differ in the last bit between libraries.
            assert float(left) == pytest.approx(float(right), rel=1e-14, abs=1e-300), text
        except ValueError:
            assert left == right, text


@pytest.mark.skipif(not PUBLISHED, reason="TRUECUT_ROBOTS is not set")
@pytest.mark.parametrize("file", published(), ids=lambda file: file.name)
def test_crosscheck_xacro_published_arms(truecut, file, tmp_path):
    try:
        theirs = reference(file, packages=PUBLISHED)
    except xacro.XacroException as error:
        # A file that the reference program does not expand, either, without the argument that names a file.
        refused = truecut.run("robot", file, "--urdf-text")
        assert refused.returncode == 2 and "--arg joint_velocities_file=FILE" in refused.stderr, error
        # With one, of speeds for every joint, both do.
        names = sorted(set(re.findall(r"velocities\['(\w+)'\]", file.with_name(f"{file.stem}_macro.xacro").read_text())))
        speeds = tmp_path / "speeds.yaml"
        speeds.write_text("".join(f"{name}: {100 + 7 * index}\n" for index, name in enumerate(names)))
        given = {"joint_velocities_file": str(speeds)}
        theirs = reference(file, given, packages=PUBLISHED)
        assert_same(ours(truecut, file, given, ["--package", f"speeds={tmp_path}"]), theirs)
        return
    assert_same(ours(truecut, file), theirs)
