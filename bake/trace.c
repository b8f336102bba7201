#include <lambent/trace.h>

#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <embree3/rtcore.h>

#include <lambent/ray_record.h>

#include "bake_internal.h"
#include "inside_out.h"
#include "trace_internal.h"

/* Up to this many placed triangles every instance becomes geometry of its own in world space, which traces faster;
 * beyond it, meshes that are used more than once become Embree instances. */
#define FLATTEN_MAX_TRIANGLES 16000000u

struct lmb_tracer {
    const lmb_scene *scene;
    RTCDevice device;
    RTCScene world;
    RTCScene *mesh_scene;    /* [mesh] for meshes that are instanced, else NULL */
    lmb_vec3 **world_vertex; /* [instance] Embree's own vertex buffer when flattened, else NULL */
    bool *is_see_through;    /* [material] lets some light straight through */
    bool *is_mirrored;       /* [instance] winding is the other way round in world space, or counts as if it were */
    uint8_t *facing;         /* [instance] lmb_facing */
    bool any_see_through;
    lmb_ray_recorder *recorder; /* NULL: rays are not recorded */
    long long bytes;
};

static bool count_bytes(void *context, ssize_t bytes, bool post)
{
    (void)post;
    __atomic_fetch_add(&((lmb_tracer *)context)->bytes, (long long)bytes, __ATOMIC_RELAXED);
    return true;
}

static bool material_is_see_through(const lmb_material *material)
{
    return material->alpha_mode != LMB_ALPHA_OPAQUE || material->transmission > 0.0f;
}

/* Triangles of a mesh, at `to_world` or in mesh space when that is NULL. Returns Embree's vertex buffer. */
static lmb_vec3 *geometry_add(lmb_tracer *tracer, RTCScene scene, unsigned id, const lmb_mesh *mesh,
                              const lmb_affine *to_world)
{
    RTCGeometry geometry = rtcNewGeometry(tracer->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    if (!geometry) {
        return NULL;
    }
    /* Embree wants readable bytes past the last vertex; its own buffers have them. */
    lmb_vec3 *vertex = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(lmb_vec3),
                                               mesh->vertex_count);
    uint32_t *index = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              3 * sizeof(uint32_t), mesh->triangle_count);
    if (vertex && index) {
        for (uint32_t i = 0; i < mesh->vertex_count; ++i) {
            vertex[i] = to_world ? affine_point(to_world, mesh->position[i]) : mesh->position[i];
        }
        memcpy(index, mesh->triangle, mesh->triangle_count * sizeof mesh->triangle[0]);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene, geometry, id);
    }
    rtcReleaseGeometry(geometry);
    return index ? vertex : NULL;
}

static RTCScene scene_new(lmb_tracer *tracer)
{
    RTCScene scene = rtcNewScene(tracer->device);
    if (scene) {
        /* Robust: no ray may slip between two triangles that share an edge. The filter counts crossings. */
        rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    }
    return scene;
}

static bool instance_add(lmb_tracer *tracer, unsigned id, const lmb_instance *instance)
{
    const lmb_mesh *mesh = &tracer->scene->meshes[instance->mesh];
    RTCScene *shared = &tracer->mesh_scene[instance->mesh];
    if (!*shared) {
        *shared = scene_new(tracer);
        if (!*shared || !geometry_add(tracer, *shared, 0, mesh, NULL)) {
            return false;
        }
        rtcCommitScene(*shared);
    }
    RTCGeometry geometry = rtcNewGeometry(tracer->device, RTC_GEOMETRY_TYPE_INSTANCE);
    if (!geometry) {
        return false;
    }
    float transform[12];
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) {
            transform[4 * row + column] = (float)instance->to_world.m[row][column];
        }
    }
    rtcSetGeometryInstancedScene(geometry, *shared);
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, transform);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(tracer->world, geometry, id);
    rtcReleaseGeometry(geometry);
    return true;
}

static bool geometry_build(lmb_tracer *tracer)
{
    const lmb_scene *scene = tracer->scene;
    uint64_t placed = 0;
    uint32_t *uses = calloc(scene->mesh_count + 1u, sizeof *uses);
    if (!uses) {
        return false;
    }
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        placed += scene->meshes[scene->instances[i].mesh].triangle_count;
        ++uses[scene->instances[i].mesh];
    }
    bool good = true;
    for (uint32_t i = 0; i < scene->instance_count && good; ++i) {
        const lmb_instance *instance = &scene->instances[i];
        const lmb_mesh *mesh = &scene->meshes[instance->mesh];
        if (instance->dynamic || mesh->triangle_count == 0) {
            continue;
        }
        if (placed <= FLATTEN_MAX_TRIANGLES || uses[instance->mesh] == 1) {
            tracer->world_vertex[i] = geometry_add(tracer, tracer->world, i, mesh, &instance->to_world);
            good = tracer->world_vertex[i] != NULL;
        } else {
            good = instance_add(tracer, i, instance);
        }
    }
    free(uses);
    if (good) {
        rtcCommitScene(tracer->world);
    }
    return good && rtcGetDeviceError(tracer->device) == RTC_ERROR_NONE;
}

/* Embree falls back without a word on names that it does not know. */
static bool isa_is_known(const char *isa)
{
    static const char *const names[] = {"sse2", "sse4.2", "avx", "avx2", "avx512"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i) {
        if (strcmp(isa, names[i]) == 0) {
            return true;
        }
    }
    return false;
}

/* From here on, the fronts of what is inside out are those that are seen. */
static bool inside_out_turn(lmb_tracer *tracer)
{
    uint8_t *const facing = calloc(tracer->scene->instance_count + 1u, sizeof *facing);
    const bool good = facing && lmb_inside_out_find(tracer, facing) == LMB_OK;
    for (uint32_t i = 0; good && i < tracer->scene->instance_count; ++i) {
        tracer->facing[i] = facing[i];
        tracer->is_mirrored[i] = tracer->is_mirrored[i] != (facing[i] == LMB_FACING_TURNED);
    }
    free(facing);
    return good;
}

lmb_result lmb_tracer_create(const lmb_scene *scene, const char *isa, int threads, lmb_tracer **tracer,
                             lmb_error *error)
{
    if (isa && !isa_is_known(isa)) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "there is no instruction set '%s'", isa);
    }
    char config[128];
    snprintf(config, sizeof config, "%s%s%sthreads=%d", isa ? "isa=" : "", isa ? isa : "", isa ? "," : "",
             threads > 0 ? threads : 0);
    lmb_tracer *created = calloc(1, sizeof *created);
    if (!created) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    created->scene = scene;
    created->mesh_scene = calloc(scene->mesh_count + 1u, sizeof(RTCScene));
    created->world_vertex = calloc(scene->instance_count + 1u, sizeof *created->world_vertex);
    created->is_see_through = calloc(scene->material_count + 1u, sizeof *created->is_see_through);
    created->is_mirrored = calloc(scene->instance_count + 1u, sizeof *created->is_mirrored);
    created->facing = calloc(scene->instance_count + 1u, sizeof *created->facing);
    if (!created->mesh_scene || !created->world_vertex || !created->is_see_through || !created->is_mirrored ||
        !created->facing) {
        lmb_tracer_destroy(created);
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    for (uint32_t i = 0; i < scene->material_count; ++i) {
        created->is_see_through[i] = material_is_see_through(&scene->materials[i]);
        created->any_see_through |= created->is_see_through[i];
    }
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        created->is_mirrored[i] = scene->instances[i].mirrored;
    }
    created->device = rtcNewDevice(config);
    const enum RTCError fault = rtcGetDeviceError(created->device); /* of a device that could not be made too */
    if (!created->device || fault != RTC_ERROR_NONE) {
        lmb_tracer_destroy(created);
        if (fault == RTC_ERROR_OUT_OF_MEMORY || fault == RTC_ERROR_UNKNOWN) {
            return lmb_error_set(error, LMB_ERROR_MEMORY, "Embree cannot start: out of memory, or of threads");
        }
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "Embree cannot start here%s%s", isa ? " with isa " : "",
                             isa ? isa : "");
    }
    rtcSetDeviceMemoryMonitorFunction(created->device, count_bytes, created);
    created->world = scene_new(created);
    if (!created->world || !geometry_build(created) || !inside_out_turn(created)) {
        lmb_tracer_destroy(created);
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory while building the BVH");
    }
    *tracer = created;
    return LMB_OK;
}

void lmb_tracer_destroy(lmb_tracer *tracer)
{
    if (!tracer) {
        return;
    }
    if (tracer->world) {
        rtcReleaseScene(tracer->world);
    }
    for (uint32_t i = 0; tracer->mesh_scene && i < tracer->scene->mesh_count; ++i) {
        if (tracer->mesh_scene[i]) {
            rtcReleaseScene(tracer->mesh_scene[i]);
        }
    }
    if (tracer->device) {
        rtcReleaseDevice(tracer->device);
    }
    free(tracer->mesh_scene);
    free(tracer->world_vertex);
    free(tracer->is_see_through);
    free(tracer->is_mirrored);
    free(tracer->facing);
    free(tracer);
}

const lmb_scene *lmb_tracer_scene(const lmb_tracer *tracer)
{
    return tracer->scene;
}

lmb_facing lmb_tracer_facing(const lmb_tracer *tracer, uint32_t instance)
{
    return (lmb_facing)tracer->facing[instance];
}

bool lmb_tracer_is_turned(const lmb_tracer *tracer, uint32_t instance)
{
    return tracer->facing[instance] == LMB_FACING_TURNED;
}

const lmb_vec3 *lmb_tracer_world_vertices(const lmb_tracer *tracer, uint32_t instance)
{
    return tracer->world_vertex[instance];
}

struct RTCSceneTy *lmb_tracer_world(const lmb_tracer *tracer)
{
    return tracer->world;
}

void lmb_tracer_record(lmb_tracer *tracer, lmb_ray_recorder *recorder)
{
    tracer->recorder = recorder;
}

size_t lmb_tracer_bytes(const lmb_tracer *tracer)
{
    return tracer->bytes > 0 ? (size_t)tracer->bytes : 0;
}

static struct RTCRay ray_make(lmb_vec3 origin, lmb_vec3 direction, float near_distance, float far_distance)
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
        lmb_ray_record(tracer->recorder, kind, vec3(ray->org_x, ray->org_y, ray->org_z),
                       vec3(ray->dir_x, ray->dir_y, ray->dir_z), ray->tnear, ray->tfar);
    }
}

static bool hit_is_instanced(const struct RTCHit *hit)
{
    return hit->instID[0] != RTC_INVALID_GEOMETRY_ID;
}

static uint32_t hit_instance(const struct RTCHit *hit)
{
    return hit_is_instanced(hit) ? hit->instID[0] : hit->geomID;
}

/* Embree's normal is that of the winding in the space of the geometry. In world space mirroring turns the winding; what
 * the inverse transpose brings there keeps its side. */
static bool hit_is_front(const lmb_tracer *tracer, const struct RTCHit *hit, lmb_vec3 direction)
{
    const lmb_vec3 normal = vec3(hit->Ng_x, hit->Ng_y, hit->Ng_z);
    const uint32_t instance = hit_instance(hit);
    if (hit_is_instanced(hit)) {
        const lmb_affine *to_world = &tracer->scene->instances[instance].normal_to_world;
        return (vec3_dot(affine_vector(to_world, normal), direction) <= 0.0f) !=
               (tracer->facing[instance] == LMB_FACING_TURNED);
    }
    return (vec3_dot(normal, direction) <= 0.0f) != tracer->is_mirrored[instance];
}

static void hit_set(const lmb_tracer *tracer, const struct RTCRayHit *ray, lmb_hit *hit)
{
    hit->instance = hit_instance(&ray->hit);
    hit->triangle = ray->hit.primID;
    hit->u = ray->hit.u;
    hit->v = ray->hit.v;
    hit->distance = ray->ray.tfar;
    hit->front = hit_is_front(tracer, &ray->hit, vec3(ray->ray.dir_x, ray->ray.dir_y, ray->ray.dir_z));
}

bool lmb_trace_nearest(const lmb_tracer *tracer, lmb_vec3 origin, lmb_vec3 direction, float near_distance,
                       float far_distance, lmb_hit *hit)
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    struct RTCRayHit ray = {
        .ray = ray_make(origin, direction, near_distance, far_distance),
        .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .instID = {RTC_INVALID_GEOMETRY_ID}},
    };
    ray_note(tracer, LMB_RAY_NEAREST, &ray.ray);
    rtcIntersect1(tracer->world, &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
        return false;
    }
    hit_set(tracer, &ray, hit);
    return true;
}

/* Rays that Embree traces as one. What each hits is the same as when it is traced alone, bit by bit. */
enum { PACKET = 8 };

static _Alignas(32) const int packet_all[PACKET] = {-1, -1, -1, -1, -1, -1, -1, -1};

static struct RTCRay ray_of_batch(const lmb_ray_batch *rays, uint32_t i)
{
    return ray_make(vec3(rays->origin[0][i], rays->origin[1][i], rays->origin[2][i]),
                    vec3(rays->direction[0][i], rays->direction[1][i], rays->direction[2][i]), 0.0f,
                    rays->far_distance[i]);
}

static void batch_note(const lmb_tracer *tracer, lmb_ray_kind kind, const lmb_ray_batch *rays)
{
    for (uint32_t i = 0; tracer->recorder && i < rays->count; ++i) {
        const struct RTCRay ray = ray_of_batch(rays, i);
        ray_note(tracer, kind, &ray);
    }
}

static void packet_fill(struct RTCRay8 *packet, const lmb_ray_batch *rays, uint32_t first)
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
        packet->id[lane] = 0;
        packet->flags[lane] = 0;
    }
}

static void hit_set_or_nothing(const lmb_tracer *tracer, const struct RTCRayHit *ray, lmb_hit *hit)
{
    if (ray->hit.geomID == RTC_INVALID_GEOMETRY_ID) {
        hit->instance = LMB_HIT_NOTHING;
    } else {
        hit_set(tracer, ray, hit);
    }
}

/* What hit_set reads of a ray. */
static struct RTCRayHit packet_lane(const struct RTCRayHit8 *packet, int lane)
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

static void packet_nearest(const lmb_tracer *tracer, const lmb_ray_batch *rays, uint32_t first, lmb_hit hit[PACKET])
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    struct RTCRayHit8 packet;
    packet_fill(&packet.ray, rays, first);
    for (int lane = 0; lane < PACKET; ++lane) {
        packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
        packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect8(packet_all, tracer->world, &context, &packet);
    for (int lane = 0; lane < PACKET; ++lane) {
        const struct RTCRayHit ray = packet_lane(&packet, lane);
        hit_set_or_nothing(tracer, &ray, &hit[lane]);
    }
}

void lmb_trace_nearest_batch(const lmb_tracer *tracer, const lmb_ray_batch *rays, lmb_hit hit[LMB_RAY_BATCH])
{
    batch_note(tracer, LMB_RAY_NEAREST, rays);
    uint32_t i = 0;
    for (; i + PACKET <= rays->count; i += PACKET) {
        packet_nearest(tracer, rays, i, &hit[i]);
    }
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (; i < rays->count; ++i) {
        struct RTCRayHit ray = {
            .ray = ray_of_batch(rays, i),
            .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .instID = {RTC_INVALID_GEOMETRY_ID}},
        };
        rtcIntersect1(tracer->world, &context, &ray);
        hit_set_or_nothing(tracer, &ray, &hit[i]);
    }
}

bool lmb_tracer_is_see_through(const lmb_tracer *tracer, uint32_t instance, uint32_t triangle)
{
    const lmb_mesh *mesh = &tracer->scene->meshes[tracer->scene->instances[instance].mesh];
    return tracer->is_see_through[mesh->material[triangle]];
}

typedef struct crossing_context {
    struct RTCIntersectContext embree; /* first: Embree hands it back */
    const lmb_tracer *tracer;
    lmb_vec3 direction;
    int crossings;
} crossing_context;

/* Counts a hit and sends the ray on. */
static void crossing_count(const struct RTCFilterFunctionNArguments *arguments)
{
    crossing_context *context = (crossing_context *)arguments->context;
    const struct RTCHit *hit = (const struct RTCHit *)arguments->hit; /* of one ray: N is 1 */
    arguments->valid[0] = 0;
    if (!lmb_tracer_is_see_through(context->tracer, hit_instance(hit), hit->primID)) {
        context->crossings += hit_is_front(context->tracer, hit, context->direction) ? -1 : 1;
    }
}

int lmb_trace_crossings(const lmb_tracer *tracer, lmb_vec3 origin, lmb_vec3 direction)
{
    crossing_context context = {.tracer = tracer, .direction = direction};
    rtcInitIntersectContext(&context.embree);
    context.embree.filter = crossing_count;
    struct RTCRayHit ray = {
        .ray = ray_make(origin, direction, 0.0f, FLT_MAX),
        .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .instID = {RTC_INVALID_GEOMETRY_ID}},
    };
    ray_note(tracer, LMB_RAY_CROSSINGS, &ray.ray);
    rtcIntersect1(tracer->world, &context.embree, &ray);
    return context.crossings;
}

typedef struct shadow_context {
    struct RTCIntersectContext embree; /* first: Embree hands it back */
    const lmb_tracer *tracer;
    bool met_see_through;
} shadow_context;

/* Sends a shadow ray on through what is see-through. */
static void shadow_filter(const struct RTCFilterFunctionNArguments *arguments)
{
    shadow_context *context = (shadow_context *)arguments->context;
    const struct RTCHit *hit = (const struct RTCHit *)arguments->hit; /* of one ray: N is 1 */
    if (lmb_tracer_is_see_through(context->tracer, hit_instance(hit), hit->primID)) {
        context->met_see_through = true;
        arguments->valid[0] = 0;
    }
}

/* Whether something opaque is in the way; if not, `*met_see_through` tells whether something else may be. */
static bool trace_blocked(const lmb_tracer *tracer, lmb_vec3 origin, lmb_vec3 direction, float far_distance,
                          bool *met_see_through)
{
    shadow_context context = {.tracer = tracer};
    rtcInitIntersectContext(&context.embree);
    context.embree.filter = tracer->any_see_through ? shadow_filter : NULL;
    struct RTCRay ray = ray_make(origin, direction, 0.0f, far_distance);
    ray_note(tracer, LMB_RAY_OCCLUDED, &ray);
    rtcOccluded1(tracer->world, &context.embree, &ray);
    *met_see_through = context.met_see_through;
    return ray.tfar < 0.0f;
}

/* Walks through see-through surfaces, layer by layer. The distance to the next start is nudged by the hit's own
 * rounding only: coincident layers may count once, which is what coincident faces are. */
static lmb_rgb layers_transmittance(const lmb_tracer *tracer, lmb_vec3 origin, lmb_vec3 direction, float far_distance,
                                    uint64_t *rays)
{
    lmb_rgb share = {{1.0f, 1.0f, 1.0f}};
    float start = 0.0f;
    lmb_hit hit;
    for (;;) {
        ++*rays;
        if (!lmb_trace_nearest(tracer, origin, direction, start, far_distance, &hit)) {
            return share;
        }
        if (!lmb_tracer_is_see_through(tracer, hit.instance, hit.triangle)) {
            return rgb(0.0f, 0.0f, 0.0f);
        }
        share = rgb_mul(share, lmb_trace_surface(tracer, hit.instance, hit.triangle, hit.u, hit.v).pass);
        start = nextafterf(hit.distance * (1.0f + 4.0f * FLT_EPSILON), FLT_MAX);
        if (!(rgb_max(share) > 0.0f) || start >= far_distance) {
            return share;
        }
    }
}

/* Most rays meet nothing, or something opaque: only the others are walked. */
lmb_rgb lmb_trace_transmittance_along(const lmb_tracer *tracer, lmb_vec3 origin, lmb_vec3 direction, float far_distance,
                                      uint64_t *rays)
{
    bool met_see_through;
    ++*rays;
    if (trace_blocked(tracer, origin, direction, far_distance, &met_see_through)) {
        return rgb(0.0f, 0.0f, 0.0f);
    }
    return met_see_through ? layers_transmittance(tracer, origin, direction, far_distance, rays)
                           : rgb(1.0f, 1.0f, 1.0f);
}

lmb_rgb lmb_trace_transmittance(const lmb_tracer *tracer, lmb_vec3 from, lmb_vec3 to, uint64_t *rays)
{
    return lmb_trace_transmittance_along(tracer, from, vec3_sub(to, from), LMB_TRACE_UP_TO_END, rays);
}

static lmb_rgb share_of_occluded(float far_distance)
{
    const float open = far_distance < 0.0f ? 0.0f : 1.0f;
    return rgb(open, open, open);
}

static void packet_occluded(const lmb_tracer *tracer, const lmb_ray_batch *rays, uint32_t first, lmb_rgb share[PACKET])
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    struct RTCRay8 packet;
    packet_fill(&packet, rays, first);
    rtcOccluded8(packet_all, tracer->world, &context, &packet);
    for (int lane = 0; lane < PACKET; ++lane) {
        share[lane] = share_of_occluded(packet.tfar[lane]);
    }
}

void lmb_trace_transmittance_batch(const lmb_tracer *tracer, const lmb_ray_batch *rays, lmb_rgb share[LMB_RAY_BATCH],
                                   uint64_t *rays_traced)
{
    if (tracer->any_see_through) {
        for (uint32_t i = 0; i < rays->count; ++i) {
            const struct RTCRay ray = ray_of_batch(rays, i);
            share[i] = lmb_trace_transmittance_along(tracer, vec3(ray.org_x, ray.org_y, ray.org_z),
                                                     vec3(ray.dir_x, ray.dir_y, ray.dir_z), ray.tfar, rays_traced);
        }
        return;
    }
    batch_note(tracer, LMB_RAY_OCCLUDED, rays);
    uint32_t i = 0;
    for (; i + PACKET <= rays->count; i += PACKET) {
        packet_occluded(tracer, rays, i, &share[i]);
    }
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (; i < rays->count; ++i) {
        struct RTCRay ray = ray_of_batch(rays, i);
        rtcOccluded1(tracer->world, &context, &ray);
        share[i] = share_of_occluded(ray.tfar);
    }
    *rays_traced += rays->count;
}

float lmb_trace_epsilon(lmb_vec3 position)
{
    return trace_epsilon(position);
}

lmb_vec3 lmb_trace_offset(lmb_vec3 position, lmb_vec3 geometric_normal, float rounding, lmb_vec3 direction)
{
    return trace_offset(position, geometric_normal, rounding, direction);
}
