#pragma once

#include <cmath>

namespace mole
{
inline double depth_after(double seconds) {return std::sqrt(seconds);}
}  // namespace mole
