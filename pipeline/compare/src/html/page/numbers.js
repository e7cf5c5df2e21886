// Numbers as texts.

/** All digits that tell a float32 from its neighbours. */
function float32Text(value) {
  if (!Number.isFinite(value)) return Number.isNaN(value) ? "NaN" : value > 0 ? "inf" : "−inf";
  for (let digits = 1; digits < 9; digits++) {
    const short = Number(value.toPrecision(digits));
    if (Math.fround(short) === value) return numberText(short);
  }
  return numberText(Number(value.toPrecision(9)));
}

/** As short as JavaScript has it, with a minus sign of full width; null is what JSON has for numbers that are not finite. */
function numberText(value) {
  if (value === null) return "not finite";
  if (Object.is(value, -0)) return "−0";
  return String(value).replaceAll("-", "−");
}

/** Four digits, for tables. */
function shortText(value) {
  if (typeof value !== "number") return numberText(value);
  if (Number.isInteger(value) && Math.abs(value) < 1e9) return numberText(value);
  const size = Math.abs(value);
  return numberText(size >= 1e-3 && size < 1e5 ? Number(value.toPrecision(4)) : value.toExponential(3)).replace("e+", "e");
}

/** The same with its sign. */
function signedText(value) {
  return value > 0 ? `+${shortText(value)}` : shortText(value);
}

/** 1, 2 or 5 times a power of ten, not below the value. */
function niceAbove(value) {
  if (!(value > 0) || !Number.isFinite(value)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  const step = [1, 2, 5, 10].find((factor) => Number((factor * power).toPrecision(12)) >= value);
  return Number(((step ?? 10) * power).toPrecision(12));
}
