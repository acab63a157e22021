// Multiple scattering in a stack of like fibres, which stands for a disciplined cluster of hair: the local
// multiple scattering of Dual Scattering (Zinke, Yuksel, Weber, Keyser 2008, section 3.2). Light comes in at
// one end. At each fibre it is scattered forward, backward, or absorbed.
#pragma once

namespace strandcast {

/// What a fibre does to light of one colour and one inclination, averaged over azimuth (eq. 6 and 12).
struct LayerScattering {
  double forward = 0, backward = 0;                    ///< shares of light: 0 to 1, together at most 1
  double forward_shift = 0, backward_shift = 0;        ///< of the inclination, rad
  double forward_variance = 0, backward_variance = 0;  ///< of the inclination, rad^2
};

/// Light that comes back out of a stack after it has passed its first fibre. The light that the first fibre
/// itself sends back is left out, because single scattering has it.
struct Backscattering {
  double attenuation = 0;  ///< share of light: average backscattering attenuation
  double shift = 0;        ///< rad
  double variance = 0;     ///< rad^2
};

/// By eq. 11, 13 and 14 with the fits of eq. 16 and 17: one and three scatterings backward. The sums have
/// poles at forward = 1: it counts as 0.9999 at most.
Backscattering paperBackscattering(const LayerScattering& layer);

/// Any number of scatterings in an endless stack. The attenuation is exact (Stokes 1862: a layer on a stack
/// is the same stack). Shift and variance are those of the normal distribution that has the same second
/// trigonometric moment, E[e^(2 i theta)], as the true one. So they are finite even without absorption.
Backscattering fullBackscattering(const LayerScattering& layer);

}  // namespace strandcast
