/* The options that decide what a bake makes. */
#ifndef LMB_TOOLS_BAKE_ARGUMENTS_H
#define LMB_TOOLS_BAKE_ARGUMENTS_H

#include <lambent/bake_settings.h>
#include <lambent/model.h>

#include "level_arguments.h"

/* The model of that name, or that the option's value names, of those that lightmaps can have. */
const lmb_model *lightmap_model_named(lmb_arguments *arguments, const char *name);
const lmb_model *lightmap_model_argument(lmb_arguments *arguments, const char *option);

/* Takes `argument` when it is the level, one of level_argument's options, or one of those of BAKE_USAGE. */
bool bake_argument(lmb_bake_settings *settings, lmb_arguments *arguments, const char *argument);
#define BAKE_USAGE                                                                                                     \
    "  --spacing M           metres between probes (default: from the level's size)\n"                                 \
    "  --min-spacing M       levels of half the spacing, a quarter and so on where light changes fast,\n"              \
    "                        down to this (default: one level)\n"                                                      \
    "  --tolerance E         error of interpolation, relative, beyond which a level finer than the\n"                  \
    "                        coarsest follows; 2.8 times that for each next one\n"                                     \
    "                        (default 0.05)\n"                                                                         \
    "  --placed-by-all       with --light-set: levels of probes by the light of all sets, as --light-sets has them\n"  \
    "  --max-probes N        the spacing grows until there are no more (default 262144)\n"                             \
    "  --seed-point X,Y,Z    bake only free space connected to this point (repeatable)\n"                              \
    "  --texels-per-m N      lightmap density (default: from the level's size)\n"                                      \
    "  --padding N           texels filled around lightmap charts and nodes, for mip levels (default 1)\n"             \
    "  --lightmap-format F   exr: half floats (default); ktx2, dds: block-compressed textures, 2.5 bytes a texel;\n"   \
    "                        ktx2-astc: for mobile hardware, 2 bytes; as many mip levels as --padding keeps apart\n"   \
    "  --models NAME,...     lightmaps in these models too (default: the format's own alone, which is always\n"        \
    "                        written: irradz-hhd, of textures irradz-hhd.disc): hlsh, sh3, or any name of\n"           \
    "                        `lambent models`\n"                                                                       \
    "  --compact             probes.lmb of little more than half the size: bytes above each probe's mean\n"            \
    "  --tile-size M         probes.lmt too, the volume in tiles of M metres for a world that is streamed: beside "    \
    "it\n"                                                                                                             \
    "                        probes_X_Y_Z.lmb, as lambent pack --tile-size writes them\n"                              \
    "  --texel-error         the standard error of each texel, as a picture\n"                                         \
    "  --no-denoise          probes and lightmaps as they were gathered, noise and all\n"                              \
    "  --quality NAME        draft, medium or high: noise of 12, 6 or 3 %, by at most 256, 1024 or\n"                  \
    "                        4096 samples at each probe and texel; a draft has half the default\n"                     \
    "                        densities (default medium)\n"                                                             \
    "  --noise E             the noise as a share of the light, in place of the quality's\n"                           \
    "  --samples N           just so many samples everywhere, in place of both\n"                                      \
    "  --estimator NAME      cached: solve the light on surfaces first, then gather it (default);\n"                   \
    "                        reference: trace every path to its end, unbiased and slower\n"

#endif
