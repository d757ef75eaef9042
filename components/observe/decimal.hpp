/// Numbers as text for files: independent of the locale, so that equal runs write equal bytes.
#pragma once

#include <string>

namespace kervan::observe {

/// `value` with `digits` decimals (0..9), never "-0.0"; an empty text if it is not finite or beyond 1e15.
std::string decimal(double value, int digits);

}  // namespace kervan::observe
