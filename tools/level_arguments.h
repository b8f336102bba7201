/* The options that every command has that takes LEVEL. */
#ifndef LMB_TOOLS_LEVEL_ARGUMENTS_H
#define LMB_TOOLS_LEVEL_ARGUMENTS_H

#include <lambent/bake_level.h>

#include "command.h"

/* Takes `option` and its value when it is one of those of LEVEL_USAGE. */
bool level_argument(lmb_level_settings *settings, lmb_arguments *arguments, const char *option);
#define LEVEL_USAGE                                                                                                    \
    "  --env FILE|#rrggbb[,rotation=DEG][,strength=X][,set=NAME]\n"                                                    \
    "                        environment: an equirectangular .hdr or .exr, or a constant colour\n"                     \
    "  --env preetham:sun=AZIMUTH/ELEVATION[,turbidity=T][,ground=ALBEDO]\n"                                           \
    "  --env preetham:time=HOURS,latitude=DEG[,day=N]...\n"                                                            \
    "                        a clear sky and its sun, in kcd/m2\n"                                                     \
    "  --env sky-basis:K[,strength=X][,set=NAME]\n"                                                                    \
    "                        one of the 9 skies, K from 0, that changing ones are blended of\n"                        \
    "  --exclude PATTERN     leave out nodes by name, with their children (* and ?; repeatable)\n"                     \
    "  --light-scale X       multiply lamps (KHR_lights_punctual) by this\n"                                           \
    "  --emission-scale X    multiply what materials emit by this\n"                                                   \
    "  --light-set NAME      the lights of that set alone ('base': those that name none)\n"                            \
    "  --key-lights N        suns kept apart from the harmonics, 0 to 4 (default 1)\n"                                 \
    "  --bounces N           reflections at most (default: no limit)\n"                                                \
    "  --seed N              of the random numbers (default 0)\n"                                                      \
    "  --threads N           (default: one for each processor)\n"                                                      \
    "  --isa NAME            pin Embree's instruction set: sse2, sse4.2, avx, avx2, avx512\n"                          \
    "  --allow-outside-uris  let the level refer to files outside its folder\n"                                        \
    "  --quiet               no progress and no warnings\n"

/* Takes `option` and its value when it is --estimator. */
bool estimator_argument(lmb_estimator *estimator, lmb_arguments *arguments, const char *option);

#endif
