//! Words of a command line that stand for the values of a library's type.

use clap::builder::{PossibleValuesParser, TypedValueParser};

/// Parses the name of one of `all` values. Libraries name their values and know nothing of command lines.
pub fn one_of<T: Copy + Send + Sync + 'static>(
    all: &'static [T],
    name: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T> {
    let names = PossibleValuesParser::new(all.iter().map(|value| name(*value)));
    names.try_map(move |word| all.iter().copied().find(|value| name(*value) == word).ok_or("expected one of the names"))
}
