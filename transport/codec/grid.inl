// Whole numbers in the lane vocabulary of kernels/README.md, as nearest() and gridIndex() have them.

/// The nearest whole number, ties to even, of |x| <= 2^22.
FN real nearestWhole(real x) { return (x + lit(12582912)) - lit(12582912); }

/// Nearest point of the grid, in steps; clamped to `most`, and -most of what is not a number.
FN real gridNumber(real position, real step, real most) {
  const real low = lit(0) - most, steps = position / step;
  const real above = select(low < steps, steps, low);
  return nearestWhole(select(above < most, above, most));
}
