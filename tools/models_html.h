/* One page of what was measured of lighting models: plots, pictures of hemispheres, tables. It needs no other file. */
#ifndef LMB_TOOLS_MODELS_HTML_H
#define LMB_TOOLS_MODELS_HTML_H

#include "models_cones.h"

typedef struct models_page {
    const models_settings *settings;
    const models_map *map;
    size_t map_count;
    const models_report *report;
    const models_cone_report *cones;
    const char *machine;
} models_page;

/* @return LMB_ERROR_MEMORY, LMB_ERROR_WRITE */
lmb_result models_html_write(const char *path, const models_page *page, lmb_error *error);

#endif
