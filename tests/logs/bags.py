"""Bags of ROS 2 messages, written by other people's writers: `mcap-ros2-support` and `rosbags`."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path
from typing import NamedTuple

from mcap.writer import CompressionType
from mcap_ros2.writer import Writer as McapWriter
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as BagWriter
from rosbags.typesys import Stores, get_typestore

ROOT = Path(__file__).resolve().parents[2]
ELBOW = ROOT / "scenarios" / "diagnosis" / "elbow.csv"
# any time of a robot's log
STARTS_NS = 1_790_000_000_123_456_789
NS = 1_000_000_000

HEADER = """
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
JOINT_STATE = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n" + HEADER
VECTOR = """
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
"""
WRENCH_STAMPED = (
    "std_msgs/Header header\ngeometry_msgs/Wrench wrench\n"
    + HEADER
    + """
================================================================================
MSG: geometry_msgs/Wrench
geometry_msgs/Vector3 force
geometry_msgs/Vector3 torque
"""
    + VECTOR
)
POSE_STAMPED = (
    "std_msgs/Header header\ngeometry_msgs/Pose pose\n"
    + HEADER
    + """
================================================================================
MSG: geometry_msgs/Pose
geometry_msgs/Point position
geometry_msgs/Quaternion orientation
================================================================================
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
================================================================================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
"""
)
FLOAT64 = "float64 data\n"
TEXTS = {
    "sensor_msgs/msg/JointState": JOINT_STATE,
    "geometry_msgs/msg/WrenchStamped": WRENCH_STAMPED,
    "geometry_msgs/msg/PoseStamped": POSE_STAMPED,
    "std_msgs/msg/Float64": FLOAT64,
}


class Message(NamedTuple):
    """A message of a topic: when it was written down and its fields, the stamp among them."""

    topic: str
    kind: str
    log_ns: int
    fields: dict


def stamped(stamp_ns: int, **fields) -> dict:
    """Fields with a header."""
    stamp = {"sec": stamp_ns // NS, "nanosec": stamp_ns % NS}
    return {"header": {"stamp": stamp, "frame_id": "world"}, **fields}


def joint_state(topic: str, stamp_ns: int, delay_ns: int, names: list[str], **values: list[float]) -> Message:
    """A `JointState`; lists that are not given are empty, as drivers write them."""
    lists = {key: list(values.get(key, [])) for key in ("position", "velocity", "effort")}
    return Message(topic, "sensor_msgs/msg/JointState", stamp_ns + delay_ns, stamped(stamp_ns, name=names, **lists))


def elbow() -> list[Message]:
    """The measurements of `scenarios/diagnosis/elbow.csv` as a robot's log has them, in SI; each topic is written
    down later than it was stamped by a time of its own."""
    messages = []
    with ELBOW.open() as file:
        for row in csv.DictReader(file):
            ns = STARTS_NS + round(float(row["t_s"]) * NS)
            names = ["shoulder", "elbow"]
            command = [math.radians(float(row[f"command_{joint}_deg"])) for joint in (1, 2)]
            effort = [float(row[f"torque_{joint}_n_m"]) for joint in (1, 2)]
            place = {"x": 0.0, "y": 0.0, "z": float(row["height_mm"]) * 1e-3}
            turned = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
            pose = stamped(ns, pose={"position": place, "orientation": turned})
            messages.append(joint_state("/command", ns, 300_000, names, position=command))
            messages.append(joint_state("/joint_states", ns, 500_000, names, effort=effort))
            messages.append(Message("/tool", "geometry_msgs/msg/PoseStamped", ns + 900_000, pose))
    return messages


ELBOW_CHANNELS = """
[[data.channel]]
column = "/command/position/shoulder"
channel = "joint1.command"
unit = "rad"
role = "input"

[[data.channel]]
column = "/command/position/elbow"
channel = "joint2.command"
unit = "rad"
role = "input"

[[data.channel]]
column = "/joint_states/effort/shoulder"
channel = "joint1.transmission_torque"
unit = "N m"

[[data.channel]]
column = "/joint_states/effort/elbow"
channel = "joint2.transmission_torque"
unit = "N m"

[[data.channel]]
column = "/tool/pose/position/z"
channel = "tool.position_z"
unit = "m"
"""


def elbow_scenario(file: Path, time: str = "header_stamp", channels: str = ELBOW_CHANNELS) -> str:
    """The scenario of the elbow with a log in place of its CSV file."""
    text = (ROOT / "scenarios" / "diagnosis" / "elbow.toml").read_text()
    head, _, rest = text.partition("[data]")
    uncertain = rest[rest.index("[[uncertain]]") :]
    head = head.replace("../../assets", str(ROOT / "assets"))
    return f'{head}[data]\nfile = "{file}"\ntime = "{time}"\n{channels}\n{uncertain}'


def write_mcap(file: Path, messages: list[Message], compression: CompressionType = CompressionType.ZSTD) -> Path:
    """Writes messages by `mcap-ros2-support`, with their definitions."""
    with file.open("wb") as stream:
        writer = McapWriter(stream, compression=compression, chunk_size=200_000)
        schemas = {}
        for one in messages:
            if one.kind not in schemas:
                schemas[one.kind] = writer.register_msgdef(one.kind, TEXTS[one.kind])
            writer.write_message(
                topic=one.topic, schema=schemas[one.kind], message=one.fields, log_time=one.log_ns, publish_time=one.log_ns
            )
        writer.finish()
    return file


def built(store, kind: str, fields: dict):
    """A message of `rosbags` from plain fields; numbers of lists as arrays of its type."""
    import numpy as np

    made = store.types[kind]
    values = {}
    for name, (sort, about) in store.fielddefs[kind][1]:
        value = fields[name]
        if sort.name == "NAME":
            values[name] = built(store, about, value)
        elif sort.name in ("ARRAY", "SEQUENCE") and about[0][1] != "string" and about[0][1][0] != "string":
            values[name] = np.array(value, dtype=np.float64)
        else:
            values[name] = value
    return made(**values)


def write_bag(folder: Path, messages: list[Message], *, sqlite: bool = False, little_endian: bool = True) -> Path:
    """Writes a ROS 2 bag by `rosbags`; its file of messages."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    storage = StoragePlugin.SQLITE3 if sqlite else StoragePlugin.MCAP
    with BagWriter(folder, version=9, storage_plugin=storage) as writer:
        connections = {}
        for one in messages:
            if one.topic not in connections:
                connections[one.topic] = writer.add_connection(one.topic, one.kind, typestore=store)
            message = built(store, one.kind, one.fields)
            data = store.serialize_cdr(message, one.kind, little_endian=little_endian)
            writer.write(connections[one.topic], one.log_ns, bytes(data))
    (found,) = folder.glob("*.db3" if sqlite else "*.mcap")
    return found


def without_definitions(messages: list[Message]) -> bytes:
    """An MCAP file with the names of the types alone, as files made of older bags have them."""
    from mcap.writer import Writer as PlainWriter

    store = get_typestore(Stores.ROS2_HUMBLE)
    stream = io.BytesIO()
    writer = PlainWriter(stream, compression=CompressionType.LZ4)
    writer.start(profile="ros2")
    channels = {}
    for one in messages:
        if one.topic not in channels:
            schema = writer.register_schema(one.kind, "", b"")
            channels[one.topic] = writer.register_channel(one.topic, "cdr", schema)
        data = store.serialize_cdr(built(store, one.kind, one.fields), one.kind)
        writer.add_message(channels[one.topic], log_time=one.log_ns, publish_time=one.log_ns, data=bytes(data))
    writer.finish()
    return stream.getvalue()


def shipped() -> None:
    """Writes the logs that lie beside this file, which fuzzing damages: some rows of the elbow, with checksums and
    without, so that damage gets past them."""
    here = Path(__file__).parent
    messages = elbow()[:90]
    write_mcap(here / "elbow.mcap", messages)
    (here / "names_alone.mcap").write_bytes(without_definitions(messages))
    with (here / "without_checksums.mcap").open("wb") as stream:
        writer = McapWriter(stream, compression=CompressionType.NONE, enable_crcs=False)
        schemas = {kind: writer.register_msgdef(kind, TEXTS[kind]) for kind in sorted({one.kind for one in messages})}
        for one in messages:
            writer.write_message(topic=one.topic, schema=schemas[one.kind], message=one.fields, log_time=one.log_ns)
        writer.finish()


if __name__ == "__main__":
    shipped()
