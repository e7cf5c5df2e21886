//! Tables in Markdown, and the numbers in them.

/// A table in Markdown.
pub fn table(header: &[&str], rows: &[Vec<String>]) -> String {
    let line = |cells: Vec<&str>| format!("| {} |\n", cells.join(" | "));
    let mut text = line(header.to_vec());
    text += &line(vec!["---"; header.len()]);
    rows.iter().for_each(|row| text += &line(row.iter().map(String::as_str).collect()));
    text
}

/// A number with three significant digits.
pub fn three(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    match x.abs().log10().floor() as i32 {
        6.. | ..-4 => format!("{x:.2e}"),
        digits => {
            let unit = 10f64.powi(digits - 2);
            format!("{:.*}", (2 - digits).max(0) as usize, (x / unit).round() * unit)
        }
    }
}

/// A share in per cent, with three significant digits.
pub fn percent(x: f64) -> String {
    format!("{} %", three(100.0 * x))
}

/// Seconds in the unit that suits them.
pub fn time(seconds: f64) -> String {
    match seconds {
        s if s < 0.1 => format!("{} ms", three(1e3 * s)),
        s if s < 600.0 => format!("{} s", three(s)),
        s if s < 4.0 * 3600.0 => format!("{} min", three(s / 60.0)),
        s if s < 4.0 * 86400.0 => format!("{} h", three(s / 3600.0)),
        s if s < 1000.0 * 86400.0 => format!("{} days", three(s / 86400.0)),
        s => format!("{} years", three(s / 31_557_600.0)),
    }
}

/// A count as `300k`, `1.5M`.
pub fn count(n: u64) -> String {
    match n {
        0..1000 => n.to_string(),
        1000..1_000_000 => format!("{}k", n as f64 / 1e3),
        _ => format!("{}M", n as f64 / 1e6),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!([0.012345, 1.0, 999.6, 312.4, 12345.0].map(three), ["0.0123", "1.00", "1000", "312", "12300"]);
        assert_eq!([3e-5, 0.0, 1.5e9].map(three), ["3.00e-5", "0", "1.50e9"]);
        assert_eq!([0.05, 7.0, 7200.0, 5e5].map(time), ["50.0 ms", "7.00 s", "120 min", "5.79 days"]);
        assert_eq!([500, 30_000, 1_600_000].map(count), ["500", "30k", "1.6M"]);
    }
}
