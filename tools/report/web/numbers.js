"use strict";
// Numbers as people read them.
carom.numbers = (() => {
  const superscript = (exponent) =>
    [...String(exponent)].map((c) => (c === "-" ? "\u207b" : "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"[c])).join("");

  /** Four significant digits, or as many as asked. */
  const short = (value, digits = 4) => {
    if (!Number.isFinite(value)) return "-";
    if (value === 0) return "0";
    const size = Math.abs(value);
    if (size >= 1e-4 && size < 1e6) return String(Number(value.toPrecision(digits)));
    const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
    return `${Number(mantissa)}\u00b710${superscript(Number(exponent))}`;
  };

  /** A mark of a logarithmic axis: powers of ten as such. */
  const power = (value) => {
    const exponent = Math.round(Math.log10(value));
    if (Math.abs(value / 10 ** exponent - 1) > 1e-9) return short(value);
    return exponent > -3 && exponent < 4 ? String(Number(value.toPrecision(1))) : `10${superscript(exponent)}`;
  };

  /** The number a table's cell starts with ("1,024", "3.5e-4 m", "-"), or null. */
  const leading = (text) => {
    const match = /^\s*[-+]?(\d[\d,]*(\.\d*)?|\.\d+)(e[-+]?\d+)?/i.exec(text);
    return match ? Number(match[0].replaceAll(",", "")) : null;
  };

  return { short, power, leading };
})();
