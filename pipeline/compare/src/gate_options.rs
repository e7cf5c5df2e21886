//! The options of the gates: one for each kind of gate that the library knows.

use clap::{Arg, ArgAction, ArgMatches, Args, Command, Error, FromArgMatches};
use compare::Gate;
use compare::metric::{GATES, GateKind, GateValue};

/// The gates of the command line.
#[derive(Clone, Debug)]
pub(crate) struct GateOptions(pub(crate) Vec<Gate>);

impl Args for GateOptions {
    fn augment_args(command: Command) -> Command {
        GATES.iter().fold(command, |command, kind| command.arg(option(kind)))
    }

    fn augment_args_for_update(command: Command) -> Command {
        GateOptions::augment_args(command)
    }
}

impl FromArgMatches for GateOptions {
    fn from_arg_matches(matches: &ArgMatches) -> Result<GateOptions, Error> {
        let gate = |kind: &GateKind| match kind.value {
            GateValue::Samples(_) => matches.get_flag(kind.name).then(|| Gate::new(kind.name, 0.0, None).ok())?,
            _ => matches.get_one::<Gate>(kind.name).copied(),
        };
        Ok(GateOptions(GATES.iter().filter_map(gate).collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = GateOptions::from_arg_matches(matches)?;
        Ok(())
    }
}

fn option(kind: &'static GateKind) -> Arg {
    let option = Arg::new(kind.name).long(kind.name).help(kind.help);
    match kind.value {
        GateValue::Samples(_) => option.action(ArgAction::SetTrue),
        GateValue::Pixels(_) => option.value_name("N@T").value_parser(|text: &str| outliers(kind.name, text)),
        GateValue::Channel(_) | GateValue::Picture(_) => {
            option.value_name("R").value_parser(|text: &str| Gate::new(kind.name, number(text), None))
        }
    }
}

/// A number, or NaN, which no gate takes as its limit.
fn number(text: &str) -> f64 {
    text.parse().unwrap_or(f64::NAN)
}

fn outliers(name: &str, text: &str) -> Result<Gate, String> {
    let (count, threshold) = text.split_once('@').unwrap_or((text, ""));
    Gate::new(name, number(count), Some(number(threshold))).map_err(|_| {
        "it must be N@T with a whole number of pixels N and an error T of at least 0, as in 3@0.5".to_owned()
    })
}
