/* What a layout says: UVs that are not used, densities that do not fit, islands of a few texels. */
#include "lightmap/lightmap_internal.h"

#include <stdio.h>

/* So many of a kind are named; the others are counted. */
enum { MOST_NAMED = 5 };

/* A box has six islands, however small it is. */
enum { FEWEST_ISLANDS = 8 };
#define SMALL_ISLANDS_SHARE 0.5

/* Below this part of what was asked for, rounding is no reason any more. */
#define LOWERED_SHARE 0.99

/* The name of a node that has the mesh; NULL when none in the lightmap has. */
static const char *mesh_node(const lmb_lightmap *lightmap, const lmb_layout_losses *losses, uint32_t mesh)
{
    const uint32_t first = losses->first_instance[mesh];
    return first != UINT32_MAX ? lightmap->scene->instances[first].name : NULL;
}

static void others_warn(const lmb_lightmap *lightmap, uint32_t count, const char *what)
{
    if (count > MOST_NAMED) {
        lmb_warn(&lightmap->settings.warnings, "%u more %s", count - MOST_NAMED, what);
    }
}

/* Meshes without TEXCOORD_1 are the rule, and said only of some among others. */
static void faults_warn(const lmb_lightmap *lightmap, const lmb_layout_losses *losses)
{
    const lmb_scene *scene = lightmap->scene;
    uint32_t bad = 0, missing = 0, all = 0;
    const char *missing_node = "";
    for (uint32_t m = 0; m < scene->mesh_count; ++m) {
        const lmb_uv_fault fault = lightmap->fault[m];
        const char *node = mesh_node(lightmap, losses, m);
        if (!node) {
            continue;
        }
        ++all;
        if (fault == LMB_UV_MISSING) {
            missing_node = missing++ == 0 ? node : missing_node;
        } else if (fault != LMB_UV_GOOD && bad++ < MOST_NAMED) {
            lmb_warn(&lightmap->settings.warnings, "node '%s': mesh '%s' has %s: others are made, in level_uv2.glb",
                     node, scene->meshes[m].name, lmb_uv_fault_text(fault));
        }
    }
    others_warn(lightmap, bad, "meshes have lightmap UVs that cannot be used");
    if (missing > 0 && missing < all) {
        lmb_warn(&lightmap->settings.warnings,
                 "%u of %u meshes have no TEXCOORD_1 (the first is node '%s'): their lightmap UVs are in level_uv2.glb",
                 missing, all, missing_node);
    }
}

static void densities_warn(const lmb_lightmap *lightmap, const double *share)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < lightmap->scene->instance_count; ++i) {
        const double asked = lmb_lightmap_density_asked(lightmap, i);
        if (lightmap->region[i].image < 0 || share[i] >= LOWERED_SHARE || count++ >= MOST_NAMED) {
            continue;
        }
        lmb_warn(&lightmap->settings.warnings,
                 "node '%s' gets %.4g texels a metre, not %g: it fills an image of %d x %d texels as it is",
                 lightmap->scene->instances[i].name, share[i] * asked, asked, (int)lightmap->settings.max_image_size,
                 (int)lightmap->settings.max_image_size);
    }
    others_warn(lightmap, count, "nodes get fewer texels a metre than asked for");
}

static void islands_warn(const lmb_lightmap *lightmap, const lmb_layout_losses *losses)
{
    uint32_t count = 0;
    for (uint32_t m = 0; m < lightmap->scene->mesh_count; ++m) {
        const lmb_uv_islands *islands = &losses->islands[m];
        const char *node = mesh_node(lightmap, losses, m);
        if (!node || islands->small_count < FEWEST_ISLANDS || islands->small_share < SMALL_ISLANDS_SHARE ||
            count++ >= MOST_NAMED) {
            continue;
        }
        lmb_warn(&lightmap->settings.warnings,
                 "node '%s': %u of %u UV islands have less than %g texels at %.3g a metre, and their borders will "
                 "show: raise --texels-per-m%s",
                 node, islands->small_count, islands->count, LMB_SMALL_ISLAND_TEXELS,
                 lmb_lightmap_density_asked(lightmap, losses->first_instance[m]),
                 lightmap->corner_uv[m] ? "" : ", or leave out its TEXCOORD_1 (larger charts are made then)");
    }
    others_warn(lightmap, count, "nodes have mostly UV islands of so few texels");
}

void lmb_lightmap_warn(const lmb_lightmap *lightmap, const lmb_layout_losses *losses)
{
    if (lightmap->settings.warnings.warn) {
        faults_warn(lightmap, losses);
        densities_warn(lightmap, losses->density_share);
        islands_warn(lightmap, losses);
    }
}
