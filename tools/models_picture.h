/* Pictures of hemispheres of shading normals, seen from above, for a page. */
#ifndef LMB_TOOLS_MODELS_PICTURE_H
#define LMB_TOOLS_MODELS_PICTURE_H

#include <stdio.h>

#include "models.h"

/* Appends one turn of a map: the irradiance of each model that is made of SH3 as a disc, and its difference from the
 * truth in luminance, red where too bright, blue where too dark. Of some turns, the one with the median error of the
 * default model is taken. `id` names the picture on the page. @return LMB_ERROR_MEMORY */
lmb_result models_picture_write(FILE *page, int id, const models_settings *settings, const models_map *map,
                                models_input input);

#endif
