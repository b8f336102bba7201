/* What the files of the level builder share. */
#ifndef LAMBENT_LEVEL_BUILDER_INTERNAL_H
#define LAMBENT_LEVEL_BUILDER_INTERNAL_H

#include "level_builder.h"

typedef struct level_vertex {
    lmb_vec3 position;
    lmb_vec3 normal;
    float tangent[4];
    float uv[2];
    float chart_m[2];     /* position within its chart */
    float lightmap_uv[2]; /* set when the level is written */
    uint32_t chart;
    int material;
} level_vertex;

typedef struct level_triangle {
    uint32_t vertex[3];
    int material;
} level_triangle;

/* A rectangle of the lightmap layout, in metres; x and y are set by level_layout_pack. */
typedef struct level_chart {
    float width, height;
    float x, y;
} level_chart;

typedef struct level_mesh {
    char *name;
    level_vertex *vertices;
    size_t vertex_count, vertex_capacity;
    level_triangle *triangles;
    size_t triangle_count, triangle_capacity;
    level_chart *charts;
    size_t chart_count, chart_capacity;
} level_mesh;

typedef struct level_image {
    char *name;
    uint8_t *png;
    size_t png_size;
} level_image;

struct lmb_level_builder {
    float gutter_m;
    bool failed; /* memory has run out: nothing more is added, and writing fails */
    level_image *images;
    size_t image_count, image_capacity;
    lmb_level_material *materials; /* names are owned copies, here and below */
    size_t material_count, material_capacity;
    level_mesh *meshes;
    size_t mesh_count, mesh_capacity;
    lmb_level_light *lights;
    size_t light_count, light_capacity;
    struct level_camera {
        char *name;
        float view_angle_rad;
    } * cameras;
    size_t camera_count, camera_capacity;
    lmb_level_node *nodes;
    size_t node_count, node_capacity;
    size_t parents_end; /* nodes from here on have no children */
};

/* Makes room for `extra` more items in a growing array. Returns the array, or NULL and marks the builder failed. */
void *level_grow(lmb_level_builder *builder, void *items, size_t count, size_t *capacity, size_t extra,
                 size_t item_size);

/* The mesh, or NULL when the builder has failed. */
level_mesh *level_mesh_at(lmb_level_builder *builder, int mesh);

/* As lmb_level_builder_add_box; aligned textures run on from box to box, as if laid out once in mesh space. */
void level_add_box(lmb_level_builder *builder, int mesh, const lmb_level_box *box, bool align_textures);

/* Packs the charts into a square by shelves, `gutter_m` apart and from the border, and sets their positions.
 * @return the square's side in metres, or a negative number when memory has run out */
float level_layout_pack(level_chart *charts, size_t count, float gutter_m);

#endif
