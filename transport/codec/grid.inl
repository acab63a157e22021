// nearest() and gridIndex() in the lane vocabulary of kernels/README.md.

/// Nearest whole number, ties to even; |x| <= 2^22.
FN real nearestWhole(real x) { return (x + lit(12582912)) - lit(12582912); }

/// Nearest grid point, in steps, clamped to +-most; -most for NaN.
FN real gridNumber(real position, real step, real most) {
  const real low = lit(0) - most, steps = position / step;
  const real above = select(low < steps, steps, low);
  return nearestWhole(select(above < most, above, most));
}
