#include "level_builder_internal.h"

#include <assert.h>
#include <math.h>

#include <lambent/vector.h>

static lmb_vec3 normalised(lmb_vec3 a)
{
    return lmb_vec3_scale(a, 1 / lmb_vec3_length(a));
}

/* Room for one chart and its vertices and triangles; NULL when the builder has failed. */
static level_mesh *reserve(lmb_level_builder *builder, int mesh, int material, size_t vertices, size_t triangles)
{
    level_mesh *target = level_mesh_at(builder, mesh);
    if (!target) {
        return NULL;
    }
    assert(material >= 0 && (size_t)material < builder->material_count);
    (void)material;
    level_vertex *grown_vertices = level_grow(builder, target->vertices, target->vertex_count, &target->vertex_capacity,
                                              vertices, sizeof *target->vertices);
    if (!grown_vertices) {
        return NULL;
    }
    target->vertices = grown_vertices;
    level_triangle *grown_triangles = level_grow(builder, target->triangles, target->triangle_count,
                                                 &target->triangle_capacity, triangles, sizeof *target->triangles);
    if (!grown_triangles) {
        return NULL;
    }
    target->triangles = grown_triangles;
    level_chart *grown_charts =
        level_grow(builder, target->charts, target->chart_count, &target->chart_capacity, 1, sizeof *target->charts);
    if (!grown_charts) {
        return NULL;
    }
    target->charts = grown_charts;
    return target;
}

static void push_triangle(level_mesh *mesh, int material, size_t a, size_t b, size_t c)
{
    mesh->triangles[mesh->triangle_count++] = (level_triangle){{(uint32_t)a, (uint32_t)b, (uint32_t)c}, material};
}

/* A vertex of the chart that is being added, `chart_m` from its lower left corner. */
static void push_vertex(const lmb_level_builder *builder, level_mesh *mesh, int material, lmb_level_point point,
                        const float chart_m[2], float height_m)
{
    const float repeats_per_m = 1 / builder->materials[material].texture_size_m;
    mesh->vertices[mesh->vertex_count++] = (level_vertex){
        .position = point.position,
        .normal = point.normal,
        .tangent = {point.tangent.x, point.tangent.y, point.tangent.z, 1},
        .uv = {chart_m[0] * repeats_per_m, (height_m - chart_m[1]) * repeats_per_m}, /* v runs down the picture */
        .chart_m = {chart_m[0], chart_m[1]},
        .chart = (uint32_t)mesh->chart_count,
        .material = material,
    };
}

void lmb_level_builder_add_patch(lmb_level_builder *builder, int mesh, int material, const lmb_level_patch *patch)
{
    assert(patch->columns > 0 && patch->rows > 0);
    const size_t columns = (size_t)patch->columns;
    const size_t rows = (size_t)patch->rows;
    level_mesh *target = reserve(builder, mesh, material, (columns + 1) * (rows + 1), 2 * columns * rows);
    if (!target) {
        return;
    }
    const size_t first = target->vertex_count;
    for (size_t row = 0; row <= rows; ++row) {
        for (size_t column = 0; column <= columns; ++column) {
            const double u = (double)column / (double)columns;
            const double v = (double)row / (double)rows;
            const float chart_m[2] = {(float)u * patch->width_m, (float)v * patch->height_m};
            push_vertex(builder, target, material, patch->surface(patch->context, u, v), chart_m, patch->height_m);
        }
    }
    for (size_t row = 0; row < rows; ++row) {
        for (size_t column = 0; column < columns; ++column) {
            const size_t corner = first + row * (columns + 1) + column;
            push_triangle(target, material, corner, corner + 1, corner + columns + 2);
            push_triangle(target, material, corner, corner + columns + 2, corner + columns + 1);
        }
    }
    target->charts[target->chart_count++] = (level_chart){.width = patch->width_m, .height = patch->height_m};
}

typedef struct quad_context {
    lmb_vec3 corner[2][2]; /* [v][u] */
    lmb_vec3 normal, tangent;
} quad_context;

static lmb_level_point quad_point(const void *context, double u, double v)
{
    const quad_context *quad = context;
    return (lmb_level_point){quad->corner[v > 0][u > 0], quad->normal, quad->tangent};
}

/* Shifts the texture of the last four vertices so that it continues from quad to quad in mesh space. */
static void align_texture(lmb_level_builder *builder, int mesh, const quad_context *quad, float height_m)
{
    level_mesh *target = level_mesh_at(builder, mesh);
    if (!target) {
        return;
    }
    level_vertex *vertices = &target->vertices[target->vertex_count - 4];
    const float repeats_per_m = 1 / builder->materials[vertices->material].texture_size_m;
    const lmb_vec3 origin = quad->corner[0][0];
    const float right = lmb_vec3_dot(origin, quad->tangent) * repeats_per_m;
    const float down = -(lmb_vec3_dot(origin, lmb_vec3_cross(quad->normal, quad->tangent)) + height_m) * repeats_per_m;
    for (int i = 0; i < 4; ++i) {
        vertices[i].uv[0] += right;
        vertices[i].uv[1] += down;
    }
}

/* A quad with exactly these corners, [v][u], so that neighbours meet without a crack. */
static quad_context add_corners(lmb_level_builder *builder, int mesh, int material, const lmb_vec3 corner[2][2])
{
    const lmb_vec3 edge_u = lmb_vec3_sub(corner[0][1], corner[0][0]);
    const lmb_vec3 edge_v = lmb_vec3_sub(corner[1][0], corner[0][0]);
    const quad_context quad = {.corner = {{corner[0][0], corner[0][1]}, {corner[1][0], corner[1][1]}},
                               .normal = normalised(lmb_vec3_cross(edge_u, edge_v)),
                               .tangent = normalised(edge_u)};
    const lmb_level_patch patch = {.columns = 1,
                                   .rows = 1,
                                   .width_m = lmb_vec3_length(edge_u),
                                   .height_m = lmb_vec3_length(edge_v),
                                   .surface = quad_point,
                                   .context = &quad};
    lmb_level_builder_add_patch(builder, mesh, material, &patch);
    return quad;
}

void lmb_level_builder_add_quad(lmb_level_builder *builder, int mesh, int material, lmb_vec3 origin, lmb_vec3 edge_u,
                                lmb_vec3 edge_v)
{
    const lmb_vec3 along_u = lmb_vec3_add(origin, edge_u);
    const lmb_vec3 corner[2][2] = {{origin, along_u}, {lmb_vec3_add(origin, edge_v), lmb_vec3_add(along_u, edge_v)}};
    add_corners(builder, mesh, material, corner);
}

void lmb_level_builder_add_triangle(lmb_level_builder *builder, int mesh, int material, lmb_vec3 a, lmb_vec3 b,
                                    lmb_vec3 c)
{
    level_mesh *target = reserve(builder, mesh, material, 3, 1);
    if (!target) {
        return;
    }
    const lmb_vec3 corners[3] = {a, b, c};
    const lmb_vec3 tangent = normalised(lmb_vec3_sub(b, a));
    const lmb_vec3 normal = normalised(lmb_vec3_cross(lmb_vec3_sub(b, a), lmb_vec3_sub(c, a)));
    const lmb_vec3 up = lmb_vec3_cross(normal, tangent);
    float x[3];
    float y[3];
    float x_min = 0;
    float x_max = 0;
    float y_max = 0;
    for (int i = 0; i < 3; ++i) {
        x[i] = lmb_vec3_dot(lmb_vec3_sub(corners[i], a), tangent);
        y[i] = lmb_vec3_dot(lmb_vec3_sub(corners[i], a), up);
        y[i] = y[i] > 0 ? y[i] : 0;
        x_min = x[i] < x_min ? x[i] : x_min;
        x_max = x[i] > x_max ? x[i] : x_max;
        y_max = y[i] > y_max ? y[i] : y_max;
    }
    const size_t first = target->vertex_count;
    for (int i = 0; i < 3; ++i) {
        const float chart_m[2] = {x[i] - x_min, y[i]};
        push_vertex(builder, target, material, (lmb_level_point){corners[i], normal, tangent}, chart_m, y_max);
    }
    push_triangle(target, material, first, first + 1, first + 2);
    target->charts[target->chart_count++] = (level_chart){.width = x_max - x_min, .height = y_max};
}

lmb_level_box lmb_level_box_of(lmb_vec3 min, lmb_vec3 max, int material)
{
    return (lmb_level_box){min, max, {material, material, material, material, material, material}, false};
}

/* A corner of the box: bits 0, 1, 2 choose the maximum of x, y, z. */
static lmb_vec3 box_corner(const lmb_level_box *box, int bits)
{
    return (lmb_vec3){bits & 1 ? box->max.x : box->min.x, bits & 2 ? box->max.y : box->min.y,
                      bits & 4 ? box->max.z : box->min.z};
}

void level_add_box(lmb_level_builder *builder, int mesh, const lmb_level_box *box, bool align_textures)
{
    /* Lower left, lower right, upper left, upper right of each face seen from outside, walls upright. */
    static const int faces[6][4] = {
        {0, 4, 2, 6}, {5, 1, 7, 3}, {0, 1, 4, 5}, {6, 7, 2, 3}, {1, 0, 3, 2}, {4, 5, 6, 7},
    };
    for (int face = 0; face < 6; ++face) {
        if (box->material[face] == LMB_LEVEL_NONE) {
            continue;
        }
        const int flip = box->inward ? 1 : 0; /* left and right are exchanged */
        const lmb_vec3 corner[2][2] = {
            {box_corner(box, faces[face][flip]), box_corner(box, faces[face][1 - flip])},
            {box_corner(box, faces[face][2 + flip]), box_corner(box, faces[face][3 - flip])}};
        const quad_context quad = add_corners(builder, mesh, box->material[face], corner);
        if (align_textures) {
            const lmb_vec3 up = lmb_vec3_sub(corner[1][0], corner[0][0]);
            align_texture(builder, mesh, &quad, lmb_vec3_length(up));
        }
    }
}

void lmb_level_builder_add_box(lmb_level_builder *builder, int mesh, const lmb_level_box *box)
{
    level_add_box(builder, mesh, box, false);
}

typedef struct sphere_face {
    const lmb_level_sphere *sphere;
    double front[3], right[3], up[3]; /* of a face of the cube around the sphere */
} sphere_face;

static lmb_level_point sphere_point(const void *context, double u, double v)
{
    const sphere_face *face = context;
    /* tan spreads the cells evenly in angle; rounded, and exactly +-1 at the borders, so that faces meet exactly. */
    const double s = u <= 0 ? -1 : u >= 1 ? 1 : (double)(float)tan(LMB_PI / 4 * (2 * u - 1));
    const double t = v <= 0 ? -1 : v >= 1 ? 1 : (double)(float)tan(LMB_PI / 4 * (2 * v - 1));
    double direction[3];
    double tangent[3];
    double length_squared = 0;
    for (int i = 0; i < 3; ++i) {
        direction[i] = face->front[i] + s * face->right[i] + t * face->up[i];
        length_squared += direction[i] * direction[i];
    }
    const double length = sqrt(length_squared);
    double along = 0;
    for (int i = 0; i < 3; ++i) {
        direction[i] /= length;
        along += direction[i] * face->right[i];
    }
    const double flat = sqrt(1 - along * along);
    for (int i = 0; i < 3; ++i) {
        tangent[i] = (face->right[i] - along * direction[i]) / flat;
    }
    const lmb_vec3 normal = {(float)direction[0], (float)direction[1], (float)direction[2]};
    return (lmb_level_point){lmb_vec3_add(face->sphere->centre, lmb_vec3_scale(normal, face->sphere->radius)),
                             lmb_vec3_scale(normal, face->sphere->inward ? -1 : 1),
                             {(float)tangent[0], (float)tangent[1], (float)tangent[2]}};
}

void lmb_level_builder_add_sphere(lmb_level_builder *builder, int mesh, int material, const lmb_level_sphere *sphere)
{
    for (int axis = 0; axis < 3; ++axis) {
        for (int side = -1; side <= 1; side += 2) {
            sphere_face face = {.sphere = sphere};
            face.front[axis] = side;
            face.right[(axis + 1) % 3] = sphere->inward ? -side : side;
            face.up[(axis + 2) % 3] = 1;
            const float width_m = (float)(LMB_PI / 2) * sphere->radius;
            const lmb_level_patch patch = {sphere->divisions, sphere->divisions, width_m, width_m, sphere_point, &face};
            lmb_level_builder_add_patch(builder, mesh, material, &patch);
        }
    }
}

/* The direction of one of the cylinder's edges; the last is the first again, to the bit. */
static lmb_vec3 cylinder_direction(int segments, int edge)
{
    const double angle = 2 * LMB_PI * (edge % segments) / segments;
    return (lmb_vec3){(float)sin(angle), 0, (float)cos(angle)};
}

static lmb_level_point cylinder_point(const void *context, double u, double v)
{
    const lmb_level_cylinder *cylinder = context;
    const lmb_vec3 out = cylinder_direction(cylinder->segments, (int)floor(u * cylinder->segments + 0.5));
    const lmb_vec3 height = {0, (float)v * cylinder->height, 0};
    return (lmb_level_point){lmb_vec3_add(lmb_vec3_add(cylinder->base, height), lmb_vec3_scale(out, cylinder->radius)),
                             out,
                             {out.z, 0, -out.x}};
}

/* A flat end as a fan; `facing` is +1 for the upper and -1 for the lower. */
static void add_cylinder_end(lmb_level_builder *builder, int mesh, int material, const lmb_level_cylinder *cylinder,
                             int facing)
{
    const size_t segments = (size_t)cylinder->segments;
    level_mesh *target = reserve(builder, mesh, material, segments, segments - 2);
    if (!target) {
        return;
    }
    const size_t first = target->vertex_count;
    const float r = cylinder->radius;
    const lmb_vec3 centre = {cylinder->base.x, cylinder->base.y + (facing > 0 ? cylinder->height : 0),
                             cylinder->base.z};
    for (int i = 0; i < cylinder->segments; ++i) {
        const lmb_vec3 out = lmb_vec3_scale(cylinder_direction(cylinder->segments, i), r);
        const lmb_level_point point = {lmb_vec3_add(centre, out), {0, (float)facing, 0}, {1, 0, 0}};
        const float chart_m[2] = {r + out.x, r - (float)facing * out.z};
        push_vertex(builder, target, material, point, chart_m, 2 * r);
    }
    for (size_t i = 1; i + 1 < segments; ++i) {
        push_triangle(target, material, first, first + (facing > 0 ? i : i + 1), first + (facing > 0 ? i + 1 : i));
    }
    target->charts[target->chart_count++] = (level_chart){.width = 2 * r, .height = 2 * r};
}

void lmb_level_builder_add_cylinder(lmb_level_builder *builder, int mesh, int material,
                                    const lmb_level_cylinder *cylinder)
{
    assert(cylinder->segments >= 3);
    const lmb_level_patch side = {.columns = cylinder->segments,
                                  .rows = 1,
                                  .width_m = (float)(2 * LMB_PI) * cylinder->radius,
                                  .height_m = cylinder->height,
                                  .surface = cylinder_point,
                                  .context = cylinder};
    lmb_level_builder_add_patch(builder, mesh, material, &side);
    add_cylinder_end(builder, mesh, material, cylinder, 1);
    add_cylinder_end(builder, mesh, material, cylinder, -1);
}
