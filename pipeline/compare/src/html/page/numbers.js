// Numbers as text.

/** A float32 with the digits that distinguish it from its neighbors. */
function float32Text(value) {
  if (!Number.isFinite(value)) return Number.isNaN(value) ? "NaN" : value > 0 ? "inf" : "−inf";
  for (let digits = 1; digits < 9; digits++) {
    const short = Number(value.toPrecision(digits));
    if (Math.fround(short) === value) return numberText(short);
  }
  return numberText(Number(value.toPrecision(9)));
}

/** A number with a minus sign of full width. JSON has null for numbers that are not finite. */
function numberText(value) {
  if (value === null) return "not finite";
  if (Object.is(value, -0)) return "−0";
  return String(value).replaceAll("-", "−");
}

/** A number with four digits, for tables. */
function shortText(value) {
  if (typeof value !== "number") return numberText(value);
  if (Number.isInteger(value) && Math.abs(value) < 1e9) return numberText(value);
  const size = Math.abs(value);
  return numberText(size >= 1e-3 && size < 1e5 ? Number(value.toPrecision(4)) : value.toExponential(3)).replace("e+", "e");
}

/** A number with four digits and its sign. */
function signedText(value) {
  return value > 0 ? `+${shortText(value)}` : shortText(value);
}

/** The smallest of 1, 2 and 5 times a power of ten that is not below a value. */
function niceAbove(value) {
  if (!(value > 0) || !Number.isFinite(value)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  const step = [1, 2, 5, 10].find((factor) => Number((factor * power).toPrecision(12)) >= value);
  return Number(((step ?? 10) * power).toPrecision(12));
}
