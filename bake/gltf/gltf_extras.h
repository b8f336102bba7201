/* What a node wants, by its `extras` and KHR_node_visibility. */
#ifndef LMB_GLTF_EXTRAS_H
#define LMB_GLTF_EXTRAS_H

#include <lambent/scene.h>
#include <lambent/warning.h>

#include "gltf/gltf_file.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum lmb_gltf_movement { LMB_GLTF_AS_ABOVE, LMB_GLTF_STANDS, LMB_GLTF_MOVES } lmb_gltf_movement;
typedef enum lmb_gltf_light_part { LMB_GLTF_BAKED, LMB_GLTF_INDIRECT, LMB_GLTF_OFF } lmb_gltf_light_part;

typedef enum lmb_gltf_lightmap {
    LMB_GLTF_MAP_AS_ABOVE,
    LMB_GLTF_MAP_ON,
    LMB_GLTF_MAP_OFF,
    LMB_GLTF_MAP_LOCAL /* by the node's local set */
} lmb_gltf_lightmap;

typedef enum lmb_gltf_local { LMB_GLTF_LOCAL_AS_ABOVE, LMB_GLTF_LOCAL_ON, LMB_GLTF_LOCAL_OFF } lmb_gltf_local;

/* What `volume` says of the node's box; 0: not told. */
typedef struct lmb_gltf_volume {
    bool is_told, exclude;
    double spacing, min_spacing, tolerance, priority;
} lmb_gltf_volume;

typedef struct lmb_gltf_marks {
    lmb_gltf_movement moves;
    lmb_gltf_light_part light;
    bool seed, has_path, cube_map;
    bool hidden; /* with all below it; the other marks count all the same */
    double path;
    lmb_gltf_lightmap lightmap;
    lmb_gltf_local local_set;
    uint32_t local_size[3];             /* 0: not told */
    double texels_per_m, texel_scale;   /* 0: as above */
    double angle_deg, radius_m;         /* of the node's light; 0: not told */
    char light_set[LMB_LIGHT_SET_NAME]; /* of the node's light; empty: none */
    lmb_gltf_volume volume;
} lmb_gltf_marks;

/* The marks of all nodes, malloc'ed. What is not understood is warned about, but for a wrong `light`.
 * @return LMB_ERROR_FORMAT, _MEMORY */
lmb_result lmb_gltf_marks_read(const lmb_gltf_file *file, const lmb_warnings *warnings, lmb_gltf_marks **marks,
                               lmb_error *error);

/* The set of lights that a material's emission belongs to, by its `extras`; empty: none is told. Other marks of a
 * material are warned about. */
void lmb_gltf_material_light_set(const lmb_gltf_file *file, const lmb_warnings *warnings, uint32_t material,
                                 char name[LMB_LIGHT_SET_NAME]);

#ifdef __cplusplus
}
#endif

#endif
