//! The `truecut` program: runs scenarios, judges their claims and writes recordings.

mod args;
mod check;
mod columns_parquet;
mod compare;
mod crosscheck;
mod data;
mod diagnose;
mod execute;
mod failure;
mod figure;
mod find;
mod identify;
mod judge;
mod lobes;
mod mjcf;
mod outputs;
mod path;
mod posture;
mod program;
mod progress;
mod robot;
mod run;
mod sweep;
mod sweep_output;
mod sweep_parquet;
mod text;
mod verdict;
mod view;

use std::io::{IsTerminal, Write};
use std::process::ExitCode;

use clap::Parser;

use crate::args::{Arguments, Command};
use crate::failure::Failure;
use crate::verdict::Verdict;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    install_reporter();
    match dispatch(arguments.command) {
        Ok(verdict) => verdict.into(),
        Err(failure) => {
            complain(&format!("{:?}", miette::Report::from(failure)));
            Verdict::BadInput.into()
        }
    }
}

fn dispatch(command: Command) -> Result<Verdict, Failure> {
    match command {
        Command::Run(arguments) => run::run(arguments.resolve()?),
        Command::Check(arguments) => check::check(&arguments.resolve()?),
        Command::View(arguments) => view::view(&arguments),
        Command::ExportMjcf(arguments) => mjcf::export(&arguments),
        Command::Crosscheck(arguments) => crosscheck::crosscheck(&arguments.resolve()?),
        Command::Compare(arguments) => compare::compare(&arguments.resolve()?),
        Command::Diagnose(arguments) => diagnose::diagnose(&arguments.resolve()?),
        Command::Lobes(arguments) => lobes::lobes(&arguments.resolve()?),
        Command::Posture(arguments) => posture::posture(&arguments.resolve()?),
        Command::Path(arguments) => path::path(&arguments),
        Command::Program(arguments) => program::program(&arguments),
        Command::Robot(arguments) => robot::describe(&arguments),
        Command::Identify(arguments) => identify::identify(&arguments),
        Command::Schema(arguments) => {
            let schema = if arguments.identification {
                truecut_scenario::Identification::json_schema()
            } else if arguments.path {
                truecut_scenario::PathJob::json_schema()
            } else {
                truecut_scenario::Scenario::json_schema()
            };
            print(&format!("{schema:#}\n"))
        }
    }
}

/// Prints to standard output; a reader that has gone away (`truecut schema | head`) is no error.
fn print(text: &str) -> Result<Verdict, Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(Failure::message(
            format!("cannot write to standard output: {error}"),
        )),
        _ => Ok(Verdict::Good),
    }
}

/// Prints to standard error; if nobody listens there, the exit code still tells.
fn complain(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// Reports break lines only where a person reads them, so that programs find whole sentences.
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
    // Fails only if a reporter is installed already; then that one serves.
    let _ = miette::set_hook(Box::new(move |_| report()));
}
