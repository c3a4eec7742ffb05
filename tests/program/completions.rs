//! Completions of shells, pages of the manual.

use std::process::{Command, Stdio};

use super::Desk;

/// Every command as the help lists it.
fn commands(desk: &Desk) -> Vec<String> {
    let help = desk.ends(0, &["--help"]);
    let listed = help.split("Commands:").nth(1).unwrap();
    let listed = listed.split("Options:").next().unwrap();
    let names = listed.lines().filter_map(|line| {
        let name = line.strip_prefix("  ")?.split_whitespace().next()?;
        (!line.starts_with("   ")).then(|| name.to_owned())
    });
    let names: Vec<String> = names.filter(|name| name != "help").collect();
    assert!(names.len() >= 20, "{names:?}");
    names
}

#[test]
fn completions_know_every_command_and_bash_takes_them() {
    let desk = Desk::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let text = desk.ends(0, &["completions", shell]);
        for name in commands(&desk) {
            assert!(text.contains(&name), "{shell}: {name}");
        }
    }
    std::fs::write(
        desk.path("truecut.bash"),
        desk.ends(0, &["completions", "bash"]),
    )
    .unwrap();
    let script = "source truecut.bash && COMP_WORDS=(truecut diag) COMP_CWORD=1 && \
                  _truecut truecut diag truecut && echo ${COMPREPLY[@]}";
    let run = Command::new("bash")
        .args(["-c", script])
        .current_dir(desk.path("."))
        .stderr(Stdio::inherit())
        .output()
        .unwrap();
    assert_eq!(String::from_utf8_lossy(&run.stdout).trim(), "diagnose");
    desk.refused(&["completions", "tcsh"], &["tcsh"]);
    desk.refused(&["completions"], &["--man"]);
}

#[test]
fn the_manual_has_a_page_for_every_command() {
    let desk = Desk::new();
    desk.ends(0, &["completions", "--man", "man"]);
    for name in commands(&desk) {
        let page = std::fs::read_to_string(desk.path(&format!("man/truecut-{name}.1"))).unwrap();
        assert!(page.contains(".SH SYNOPSIS"), "{name}");
    }
    let front = std::fs::read_to_string(desk.path("man/truecut.1")).unwrap();
    assert!(
        front.contains("robotic machining") && front.contains("Exit codes"),
        "{front}"
    );
}
