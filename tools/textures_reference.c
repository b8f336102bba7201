#include "textures_reference.h"

#include <lambent/opaque_surface.h>
#include <lambent/sequence.h>

#include "check_points.h"

enum { STREAM_POINTS = 1, STREAM_NORMALS };

void textures_point_make(const struct lmb_opaque_surface *surface, uint32_t index, uint32_t count,
                         textures_point *point)
{
    point->hit = lmb_opaque_surface_point(surface, STREAM_POINTS, index, count);
    const lmb_vec3 n_v = lmb_trace_place(surface->tracer, &point->hit).shading_normal;
    shading_normals(n_v, lmb_mix(STREAM_NORMALS, index), CHECK_NORMALS, point->normal);
}

typedef struct reference_work {
    const lmb_lightmap *lightmap;
    const check_reference *reference;
    textures_point *points;
} reference_work;

static void point_task(void *context, size_t task, int worker)
{
    (void)worker;
    const reference_work *work = context;
    const lmb_tracer *tracer = work->reference->transport->tracer;
    textures_point *at = &work->points[task];
    const lmb_lightmap_region *region = &work->lightmap->region[at->hit.instance];
    if (region->image >= 0) {
        const lmb_place place = lmb_trace_place(tracer, &at->hit);
        bool pushed_out;
        const lmb_gather_point point = lmb_surface_gather_point(tracer, &place, region->texel_size, &pushed_out);
        check_reference_gather(work->reference, &point, at->normal, at->half);
    }
}

lmb_result textures_reference_gather(const lmb_lightmap *lightmap, const check_reference *reference, lmb_pool *pool,
                                     textures_point *points, uint32_t count)
{
    reference_work work = {lightmap, reference, points};
    return lmb_pool_run(pool, count, point_task, &work, "reference", NULL);
}
