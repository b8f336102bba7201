/* The emissive triangles, as emitters_find.c finds them and emitters.c samples them. */
#ifndef LMB_EMITTERS_INTERNAL_H
#define LMB_EMITTERS_INTERNAL_H

#include <lambent/emitters.h>

#include "light/ablation.h"
#include "light/emission_part.h"
#include "light/emitter_points.h"
#include "light/light_tree.h"
#include "light/punctual.h"
#include "light/sky.h"

#define LMB_NONE UINT32_MAX

/* A triangle, or a part of one. */
typedef struct lmb_emitter {
    uint32_t instance;
    uint32_t triangle;
    lmb_light_bound bound;
    bool even;        /* opaque and without texture: `radiance` is its emission everywhere */
    bool even_points; /* its points are chosen evenly over the triangle */
    lmb_rgb radiance;
    uint32_t part; /* index into `parts`, or LMB_NONE: the whole triangle */
    uint32_t cut;  /* the triangle's first cut, where it was found whole; LMB_NONE: it has not been divided */
} lmb_emitter;

/* A half of what a cut divides: an emitter, another cut, or dark. */
typedef struct lmb_emitter_half {
    enum { LMB_HALF_DARK, LMB_HALF_EMITTER, LMB_HALF_CUT } kind;
    uint32_t index;
} lmb_emitter_half;

typedef struct lmb_emitter_cut {
    lmb_emission_cut line;
    lmb_emitter_half half[2];
} lmb_emitter_cut;

/* How a material's emission is distributed. */
typedef struct lmb_emitter_material {
    lmb_emission_map *map; /* shared by materials; NULL: no texture has a part in it */
    const lmb_texture *texture;
} lmb_emitter_material;

struct lmb_emitters {
    const lmb_tracer *tracer;
    unsigned without; /* ablation.h */
    lmb_emitter *emitters;
    lmb_emitter_shape *shapes; /* [emitter] of the whole triangle */
    uint32_t count;
    uint32_t capacity;
    uint32_t triangle_count;
    lmb_light_tree *tree;            /* of the emitters; NULL when there are none, or they are chosen evenly */
    uint32_t **emitter_of;           /* [instance] NULL, or [triangle]: index into `emitters`, or LMB_NONE */
    lmb_emitter_material *materials; /* [material] */
    lmb_emission_map **maps;
    uint32_t map_count;
    lmb_emission_part *parts; /* that are emitters of their own */
    uint32_t part_count;
    lmb_emitter_cut *cuts;
    uint32_t cut_count;
    lmb_punctual *punctual;
    lmb_sky sky;
};

/* lmb_emitters_create, without what `without` names (ablation.h): for measurements. The rooms above ask the emitters
 * what they are to go without. @return LMB_ERROR_MEMORY */
lmb_result lmb_emitters_create_without(const lmb_tracer *tracer, unsigned without, lmb_emitters **emitters);

static inline bool lmb_emitters_go_without(const lmb_emitters *emitters, unsigned part)
{
    return (emitters->without & part) != 0;
}

/* Where an emitter's triangle lies in the texture; false where that does not matter. */
bool lmb_emitter_lattice(const lmb_emitters *emitters, const lmb_emitter *emitter, lmb_emission_lattice *lattice);

/* Finds all emissive triangles. @return LMB_ERROR_MEMORY */
lmb_result lmb_emitters_find(lmb_emitters *emitters);

/* Frees what that has made. */
void lmb_emitters_forget(lmb_emitters *emitters);

/* Adds one. The capacity grows as needed. */
bool lmb_emitters_add(lmb_emitters *emitters, const lmb_emitter *added, const lmb_emitter_shape *shape);

/* Divides large triangles with textures into parts that are emitters of their own. @return LMB_ERROR_MEMORY */
lmb_result lmb_emitters_divide(lmb_emitters *emitters);

#endif
