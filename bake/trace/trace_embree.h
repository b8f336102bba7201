/* Embree's side of the tracer: what it holds, and how rays and hits are put and read. */
#ifndef LMB_TRACE_EMBREE_H
#define LMB_TRACE_EMBREE_H

#include <stdlib.h>
#include <string.h>

#include <embree3/rtcore.h>

#include <lambent/ray_record.h>

#include "base/affine.h"
#include "trace/inside_out.h"
#include "trace/surface_internal.h"
#include "trace/trace_internal.h"

struct lmb_tracer {
    const lmb_scene *scene;
    RTCDevice device;
    RTCScene world;
    RTCScene *mesh_scene;    /* [mesh] for meshes that are instanced, else NULL */
    lmb_vec3 **world_vertex; /* [instance] Embree's own vertex buffer when flattened, else NULL */
    bool *is_see_through;    /* [material] lets some light straight through */
    lmb_coverage *coverage;  /* [material] without texture and vertex colours; only of what is see-through */
    bool *is_mirrored;       /* [instance] winding is the other way round in world space, or counts as if it were */
    uint8_t *facing;         /* [instance] lmb_facing */
    bool *has_layers;        /* [instance] some of its triangles are see-through */
    bool any_see_through;
    lmb_ray_recorder *recorder; /* NULL: rays are not recorded */
    long long bytes;
};

static inline struct RTCRay ray_make(lmb_vec3 origin, lmb_vec3 direction, float near_distance, float far_distance)
{
    return (struct RTCRay){.org_x = origin.x,
                           .org_y = origin.y,
                           .org_z = origin.z,
                           .tnear = near_distance,
                           .dir_x = direction.x,
                           .dir_y = direction.y,
                           .dir_z = direction.z,
                           .tfar = far_distance,
                           .mask = ~0u};
}

/* Beside every call that traces. */
static inline void ray_note(const lmb_tracer *tracer, lmb_ray_kind kind, const struct RTCRay *ray)
{
    if (tracer->recorder) {
        lmb_ray_record(tracer->recorder, kind, lmb_vec3_of(ray->org_x, ray->org_y, ray->org_z),
                       lmb_vec3_of(ray->dir_x, ray->dir_y, ray->dir_z), ray->tnear, ray->tfar);
    }
}

static inline bool hit_is_instanced(const struct RTCHit *hit)
{
    return hit->instID[0] != RTC_INVALID_GEOMETRY_ID;
}

static inline uint32_t hit_instance(const struct RTCHit *hit)
{
    return hit_is_instanced(hit) ? hit->instID[0] : hit->geomID;
}

/* Embree's normal is that of the winding in the space of the geometry. In world space mirroring turns the winding; what
 * the inverse transpose brings there keeps its side. */
static inline bool hit_is_front(const lmb_tracer *tracer, const struct RTCHit *hit, lmb_vec3 direction)
{
    const lmb_vec3 normal = lmb_vec3_of(hit->Ng_x, hit->Ng_y, hit->Ng_z);
    const uint32_t instance = hit_instance(hit);
    if (hit_is_instanced(hit)) {
        const lmb_affine *to_world = &tracer->scene->instances[instance].normal_to_world;
        return (lmb_vec3_dot(affine_vector(to_world, normal), direction) <= 0.0f) !=
               (tracer->facing[instance] == LMB_FACING_TURNED);
    }
    return (lmb_vec3_dot(normal, direction) <= 0.0f) != tracer->is_mirrored[instance];
}

static inline void hit_set(const lmb_tracer *tracer, const struct RTCRayHit *ray, lmb_hit *hit)
{
    hit->instance = hit_instance(&ray->hit);
    hit->triangle = ray->hit.primID;
    hit->u = ray->hit.u;
    hit->v = ray->hit.v;
    hit->distance = ray->ray.tfar;
    hit->front = hit_is_front(tracer, &ray->hit, lmb_vec3_of(ray->ray.dir_x, ray->ray.dir_y, ray->ray.dir_z));
}

/* Rays that Embree traces as one. What each hits is the same as when it is traced alone, bit by bit. */
enum { PACKET = 8 };

static _Alignas(32) const int packet_all[PACKET] = {-1, -1, -1, -1, -1, -1, -1, -1};

static inline struct RTCRay ray_of_batch(const lmb_ray_batch *rays, uint32_t i)
{
    return ray_make(lmb_vec3_of(rays->origin[0][i], rays->origin[1][i], rays->origin[2][i]),
                    lmb_vec3_of(rays->direction[0][i], rays->direction[1][i], rays->direction[2][i]), 0.0f,
                    rays->far_distance[i]);
}

/* The first `count` rays. */
static inline void batch_note(const lmb_tracer *tracer, lmb_ray_kind kind, const lmb_ray_batch *rays, uint32_t count)
{
    for (uint32_t i = 0; tracer->recorder && i < count; ++i) {
        const struct RTCRay ray = ray_of_batch(rays, i);
        ray_note(tracer, kind, &ray);
    }
}

static inline void packet_fill(struct RTCRay8 *packet, const lmb_ray_batch *rays, uint32_t first)
{
    float *const org[3] = {packet->org_x, packet->org_y, packet->org_z};
    float *const dir[3] = {packet->dir_x, packet->dir_y, packet->dir_z};
    for (int axis = 0; axis < 3; ++axis) {
        memcpy(org[axis], &rays->origin[axis][first], PACKET * sizeof(float));
        memcpy(dir[axis], &rays->direction[axis][first], PACKET * sizeof(float));
    }
    memcpy(packet->tfar, &rays->far_distance[first], PACKET * sizeof(float));
    for (int lane = 0; lane < PACKET; ++lane) {
        packet->tnear[lane] = 0.0f;
        packet->time[lane] = 0.0f;
        packet->mask[lane] = ~0u;
        packet->id[lane] = (unsigned)lane;
        packet->flags[lane] = 0;
    }
}

static inline void hit_set_or_nothing(const lmb_tracer *tracer, const struct RTCRayHit *ray, lmb_hit *hit)
{
    if (ray->hit.geomID == RTC_INVALID_GEOMETRY_ID) {
        hit->instance = LMB_HIT_NOTHING;
    } else {
        hit_set(tracer, ray, hit);
    }
}

/* Finds the nearest hits of rays first .. first + PACKET - 1 that the context's filter leaves. */
static inline void packet_intersect(const lmb_tracer *tracer, struct RTCIntersectContext *context,
                                    const lmb_ray_batch *rays, uint32_t first, struct RTCRayHit8 *packet)
{
    packet_fill(&packet->ray, rays, first);
    for (int lane = 0; lane < PACKET; ++lane) {
        packet->hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
        packet->hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect8(packet_all, tracer->world, context, packet);
}

/* What hit_set reads of a ray. */
static inline struct RTCRayHit packet_lane(const struct RTCRayHit8 *packet, int lane)
{
    return (struct RTCRayHit){.ray = {.dir_x = packet->ray.dir_x[lane],
                                      .dir_y = packet->ray.dir_y[lane],
                                      .dir_z = packet->ray.dir_z[lane],
                                      .tfar = packet->ray.tfar[lane]},
                              .hit = {.Ng_x = packet->hit.Ng_x[lane],
                                      .Ng_y = packet->hit.Ng_y[lane],
                                      .Ng_z = packet->hit.Ng_z[lane],
                                      .u = packet->hit.u[lane],
                                      .v = packet->hit.v[lane],
                                      .primID = packet->hit.primID[lane],
                                      .geomID = packet->hit.geomID[lane],
                                      .instID = {packet->hit.instID[0][lane]}}};
}

#endif
