#include "lightmap/lightmap_files.h"

#include <stdio.h>

static const char *const plain[] = {"R", "G", "B", "A"};
enum { PLAIN = sizeof plain / sizeof plain[0] };
_Static_assert((int)PLAIN >= (int)LMB_KEY_LIGHTS_MOST, "a channel for each key light");

void lmb_lightmap_file_name(int32_t image, const char *kind, char name[LMB_LIGHTMAP_FILE_NAME])
{
    snprintf(name, LMB_LIGHTMAP_FILE_NAME, "lightmap_%d%s%s.exr", (int)image, kind ? "_" : "", kind ? kind : "");
}

const char *lmb_lightmap_format_name(lmb_lightmap_format format)
{
    static const char *const names[LMB_LIGHTMAP_FORMATS] = {"exr", "ktx2", "dds", "ktx2-astc"};
    return names[format];
}

const lmb_model *lmb_lightmap_default_model(lmb_lightmap_format format)
{
    return lmb_model_default(format == LMB_LIGHTMAP_EXR ? LMB_MODEL_FOR_LIGHTMAP : LMB_MODEL_FOR_TEXTURE);
}

int lmb_lightmap_format_version(const lmb_lightmap *lightmap)
{
    return lightmap->key_light_count > 0 ? LMB_LIGHTMAP_FORMAT_VERSION_WITH_KEYS : LMB_LIGHTMAP_FORMAT_VERSION;
}

lmb_lightmap_channels lmb_lightmap_key_channels(const lmb_lightmap *lightmap)
{
    const int count = (int)lightmap->key_light_count;
    const int stored = count > LMB_PICTURE_CHANNELS ? count : LMB_PICTURE_CHANNELS;
    return (lmb_lightmap_channels){lightmap->model->channel_count, count, stored, 0, plain};
}

const char *lmb_lightmap_kind(const lmb_model *model)
{
    return model->short_name ? model->short_name : model->name;
}

lmb_lightmap_channels lmb_lightmap_picture_channels(void)
{
    return (lmb_lightmap_channels){0, LMB_PICTURE_CHANNELS, LMB_PICTURE_CHANNELS, LMB_PICTURE_CHANNELS, plain};
}

lmb_lightmap_channels lmb_lightmap_model_channels(const lmb_model *model)
{
    const int first = model->irradiance_first ? LMB_PICTURE_CHANNELS : 0;
    const int count = model->channel_count - first;
    return (lmb_lightmap_channels){first, count, count, model->light_count - first,
                                   count <= PLAIN ? plain : &model->channel_name[first]};
}
