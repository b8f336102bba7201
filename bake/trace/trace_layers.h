/* Light through see-through surfaces, the layers, in one walk through the BVH.
 *
 * Embree shows a filter every triangle that a ray meets on its way, in the order of its tree. Nothing may depend on
 * that order, so a layer lets pass or stops by a hash of the ray and the triangle, and what layers leave of the light
 * is multiplied when the walk is done, nearest first. The BVH is built without spatial splits: none is shown twice. */
#ifndef LMB_TRACE_LAYERS_H
#define LMB_TRACE_LAYERS_H

#include "trace/trace_embree.h"

/* Layers that are kept on one walk; a ray that meets more takes another from there. Those that leave all of the light,
 * like the holes in a leaf, are not kept. */
enum { LMB_LAYERS = 64 };

typedef struct lmb_layer {
    float distance;
    uint32_t instance, triangle;
    lmb_rgb share;
} lmb_layer;

/* The nearest layers that a ray has passed. */
typedef struct lmb_layers {
    lmb_layer layer[LMB_LAYERS]; /* nearest first; equally near ones by instance and triangle */
    uint32_t count;
    bool more; /* others lie farther off than the last */
} lmb_layers;

/* Up to PACKET rays under way. */
typedef struct lmb_layer_walk {
    struct RTCIntersectContext embree; /* first: Embree hands it back */
    const lmb_tracer *tracer;
    const uint64_t *chance; /* [lane] what decides which layers stop a ray; unused for shadow rays */
    lmb_layers *passed;     /* [lane] */
} lmb_layer_walk;

/* A see-through surface that a filter is shown. */
typedef struct lmb_shown_hit {
    uint32_t lane;
    uint32_t instance, triangle;
    float distance;
    lmb_coverage coverage;
} lmb_shown_hit;

/* Puts a layer among those that a ray has passed. */
void lmb_layer_add(lmb_layers *passed, const lmb_layer *added);

/* What the layers before `end` leave of the light. */
lmb_rgb lmb_layers_share(const lmb_layers *passed, float end);

/* Where the next walk starts when this one left out layers before `end`; 0 when it did not. */
float lmb_layers_left_from(const lmb_layers *passed, float end);

/* Reads the i-th hit that a filter is shown. False where the surface stops all light. */
bool lmb_layer_shown(const struct RTCFilterFunctionNArguments *arguments, unsigned i, lmb_shown_hit *shown);

/* `chance` and `passed` have `lanes` elements each. */
void lmb_layer_walk_start(lmb_layer_walk *walk, const lmb_tracer *tracer, RTCFilterFunctionN filter,
                          const uint64_t *chance, lmb_layers *passed, int lanes);

#endif
