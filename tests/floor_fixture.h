/* A level under construction, for tests that know the answer by analysis: a floor, on which each case puts its own. */
#ifndef LMB_TESTS_FLOOR_FIXTURE_H
#define LMB_TESTS_FLOOR_FIXTURE_H

#include "scenes/level_builder.h"

/* A square floor about the origin, at y = 0, of the given albedo. */
static inline lmb_level_builder *floor_begin(float albedo, float half_size)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    lmb_level_material grey = lmb_level_material_default();
    grey.base_color = (lmb_rgb){{albedo, albedo, albedo}};
    const int floor = lmb_level_builder_add_mesh(builder, "floor");
    lmb_level_builder_add_quad(builder, floor, lmb_level_builder_add_material(builder, &grey),
                               (lmb_vec3){-half_size, 0, half_size}, (lmb_vec3){2 * half_size, 0, 0},
                               (lmb_vec3){0, 0, -2 * half_size});
    lmb_level_builder_place(builder, "floor", floor, (lmb_vec3){0, 0, 0});
    return builder;
}

#endif
