//! The `truecut` program: runs scenarios, judges their claims and writes recordings.

mod args;
mod check;
mod clearance;
mod compare;
mod crosscheck;
mod data;
mod diagnose;
mod excite;
mod exit_status;
mod failure;
mod figure;
mod find;
mod fit;
mod identify;
mod lobes;
mod mjcf;
mod new;
mod page;
mod part;
mod path;
mod posture;
mod program;
mod progress;
mod robot;
mod run;
mod signals;
mod spread;
mod sweep;
mod text;
mod view;
mod waiting;

use std::io::{IsTerminal, Write};
use std::process::ExitCode;

use crate::args::{Arguments, Command};
use crate::exit_status::ExitStatus;
use crate::failure::Failure;

fn main() -> ExitCode {
    let arguments = Arguments::given();
    install_reporter();
    if let Some(bytes) = arguments.max_memory {
        truecut_files::limit_memory(bytes);
    }
    match dispatch(arguments.command) {
        Ok(status) => status,
        Err(failure) => {
            complain(&format!("{:?}", miette::Report::from(failure)));
            ExitStatus::BadInput.into()
        }
    }
}

fn dispatch(command: Command) -> Result<ExitCode, Failure> {
    let status = match command {
        Command::New(arguments) => new::new(&arguments),
        Command::Run(arguments) => return run::run(&arguments),
        Command::Sweep(arguments) => return sweep::sweep(&arguments),
        Command::Check(arguments) => return check::check(&arguments),
        Command::View(arguments) => view::view(&arguments),
        Command::ExportMjcf(arguments) => mjcf::export(&arguments),
        Command::Crosscheck(arguments) => crosscheck::crosscheck(&arguments),
        Command::Compare(arguments) => compare::compare(&arguments),
        Command::Data(arguments) => data::data(&arguments),
        Command::Diagnose(arguments) => return diagnose::diagnose(&arguments),
        Command::Fit(arguments) => fit::fit(&arguments),
        Command::Excite(arguments) => excite::excite(&arguments),
        Command::Lobes(arguments) => lobes::lobes(&arguments),
        Command::Posture(arguments) => posture::posture(&arguments),
        Command::Part(arguments) => part::part(&arguments),
        Command::Path(arguments) => path::path(&arguments),
        Command::Program(arguments) => program::program(&arguments),
        Command::Robot(arguments) => robot::robot(&arguments),
        Command::Identify(arguments) => identify::identify(&arguments),
        Command::Completions(arguments) => print(&arguments.text()?),
        Command::Schema(arguments) => print(&format!("{:#}\n", arguments.schema())),
    }?;
    Ok(status.into())
}

/// Prints to standard output; a closed pipe (`truecut schema | head`) is no error.
fn print(text: &str) -> Result<ExitStatus, Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(Failure::message(
            format!("cannot write to standard output: {error}"),
        )),
        _ => Ok(ExitStatus::Good),
    }
}

/// Prints to standard error, ignoring a closed pipe: the exit code still reports the result.
fn complain(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// Error reports are wrapped on a terminal only, so that programs find whole sentences.
fn install_reporter() {
    let wrap = std::io::stderr().is_terminal();
    let report = move || -> Box<dyn miette::ReportHandler> {
        let options = miette::MietteHandlerOpts::new();
        Box::new(
            options
                .wrap_lines(wrap)
                .terminal_links(false)
                .context_lines(1)
                .build(),
        )
    };
    // Fails only if a reporter is installed already, which then is used.
    let _ = miette::set_hook(Box::new(move |_| report()));
}
