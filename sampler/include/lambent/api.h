/* How the sampler's functions are linked. The static library, which is the default, needs no definitions. For the
 * shared one LMB_SHARED is defined wherever its headers are included (the CMake target and pkg-config do so), and
 * LMB_BUILDING_SAMPLER while the library itself is compiled. */
#ifndef LAMBENT_API_H
#define LAMBENT_API_H

#if !defined(LMB_SHARED)
#define LMB_API
#elif defined(_WIN32) && defined(LMB_BUILDING_SAMPLER)
#define LMB_API __declspec(dllexport)
#elif defined(_WIN32)
#define LMB_API __declspec(dllimport)
#elif defined(__GNUC__)
#define LMB_API __attribute__((visibility("default")))
#else
#define LMB_API
#endif

#endif
