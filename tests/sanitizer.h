// What a test may not do to a program that a sanitizer watches.
#pragma once

namespace chladni {

// A sanitizer's shadow takes terabytes of addresses: with a limit the program would not start. It
// opens files of its own, too, to look at memory.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kAddressesMayBeLimited = false;
#else
inline constexpr bool kAddressesMayBeLimited = true;
#endif

}  // namespace chladni
