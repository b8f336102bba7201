/* How triangles are divided into cells, and where a cell's light is. */
#ifndef LMB_SURFACE_LIGHT_INTERNAL_H
#define LMB_SURFACE_LIGHT_INTERNAL_H

#include <math.h>

#include <lambent/pool.h>
#include <lambent/surface_light.h>
#include <lambent/vector.h>

/* The cells of one triangle. Strip i, column j is cell first + i columns + j; strips count from the apex. */
typedef struct lmb_cell_grid {
    uint32_t first;
    uint32_t strips : 14;
    uint32_t columns : 14;
    uint32_t apex : 2; /* the corner opposite the shortest edge */
    uint32_t even : 1; /* opaque, dark by itself, and of one albedo: lmb_surface_light has that and what it reflects */
    uint32_t divided : 1; /* some of its sides are in pieces */
    float cell_size;      /* metres: the longest edge of its cells */
} lmb_cell_grid;

/* Metres: what looks at a cell from nearer than half its length sees one point of it, for which its mean is no measure.
 * That mean is over the points that rays from farther off reach. */
static inline float lmb_cell_near(const lmb_cell_grid *grid)
{
    return 0.5f * grid->cell_size;
}

/* Whether rays get that far from the cell. The light of a mixed one is that of its open part. */
typedef enum lmb_openness { LMB_CELL_HIDDEN, LMB_CELL_MIXED, LMB_CELL_OPEN } lmb_openness;

/* A side on which a wall or a thing stands holds no light of its own: each of its pieces is what one point of it sees.
 */
#define LMB_SIDE_WHOLE UINT32_MAX
#define LMB_SIDE_HOLE (UINT32_MAX - 1) /* no light at all, because its cell is small: hits are looked at one by one */
enum {
    LMB_CELL_STARTS = 6,
    LMB_CELL_MOST_PIECES = 4 /* of one side: what lies in none is looked at point by point */
};

/* What lets more light through than this divides nothing. */
#define LMB_PIECE_OPEN_SHARE 0.5f

typedef struct lmb_cell_piece {
    lmb_vec3 point; /* just off the surface */
    uint32_t side;
    uint16_t starts; /* those of the side's first LMB_CELL_STARTS samples' starts that belong to it, a bit each */
    bool last;       /* of its side */
} lmb_cell_piece;

/* What has light of its own is a patch: a side is patch 2 cell (the front) or 2 cell + 1 (the back), and a piece is
 * patch 2 cell_count + its index. */
struct lmb_surface_light {
    uint32_t instance_count;
    uint32_t triangle_count; /* of all static instances together */
    uint32_t cell_count;
    uint32_t *triangle_first; /* [instance], and the count at its end: dynamic ones have none */
    lmb_cell_grid *grid;      /* [triangle], and one at its end whose `first` is the count of cells */
    lmb_rgb *albedo;          /* [triangle] of even ones */
    uint32_t *first_piece;    /* [side] LMB_SIDE_WHOLE, _HOLE, or its first piece; NULL: all sides are whole */
    lmb_cell_piece *piece;    /* [piece] those of one side together */
    uint32_t piece_count;
    lmb_rgb *irradiance; /* [patch] */
    lmb_rgb *radiance;   /* [patch] irradiance x albedo, of even triangles */
    uint8_t *openness;   /* [patch] an lmb_openness */
    lmb_rgb *sun;        /* [patch] of uneven ones, else black: the part of `irradiance` that directional lights give;
                            at a hit it is found anew; NULL: all are even */
    struct lmb_bright_cells *bright; /* NULL: none */
    float cell_size;                 /* metres: the largest of all */
};

/* A cell found from its index. */
typedef struct lmb_cell {
    uint32_t instance;
    uint32_t triangle; /* of the instance's mesh */
    uint32_t index;    /* within the triangle */
    const lmb_cell_grid *grid;
} lmb_cell;

/* Divides the static triangles into cells of `cell_size` metres (0: as small as `max_cells` allows; larger where there
 * would be more); all light is 0. */
lmb_result lmb_surface_light_create(const lmb_tracer *tracer, float cell_size, uint32_t max_cells,
                                    lmb_surface_light **light, lmb_error *error);

lmb_cell lmb_cell_find(const lmb_surface_light *light, uint32_t cell);

/* Whether a cell is less than half as long as cells can be. */
static inline bool lmb_cell_is_small(const lmb_surface_light *light, const lmb_cell_grid *grid)
{
    return grid->cell_size < 0.5f * light->cell_size;
}

/* Makes room for the light of all patches, which is 0. */
lmb_result lmb_surface_light_allocate(lmb_surface_light *light);

static inline uint32_t lmb_patch_count(const lmb_surface_light *light)
{
    return 2 * light->cell_count + light->piece_count;
}

/* The side that a patch is, or is a piece of. */
static inline uint32_t lmb_patch_side(const lmb_surface_light *light, uint32_t patch)
{
    const uint32_t sides = 2 * light->cell_count;
    return patch < sides ? patch : light->piece[patch - sides].side;
}

static inline bool lmb_side_is_whole(const lmb_surface_light *light, uint32_t side)
{
    return !light->first_piece || light->first_piece[side] == LMB_SIDE_WHOLE;
}

/* Whether a patch lies partly in a shadow, of the sun, so that its mean is too bright there. */
static inline bool lmb_patch_is_uneven(const lmb_surface_light *light, uint32_t patch)
{
    return light->sun && lmb_rgb_max(light->sun[patch]) > 0.0f;
}

/* Square metres of a patch of that cell. */
float lmb_patch_area(const lmb_surface_light *light, const lmb_tracer *tracer, const lmb_cell *cell, uint32_t patch);

/* Which part of its triangle a cell is. */
typedef struct lmb_cell_part {
    float strip, strips;
    float column, columns;
} lmb_cell_part;

lmb_cell_part lmb_cell_part_of(const lmb_cell *cell);

/* A point of the part, uniform over its area for uniform u in [0, 1)^2: how far it is from the apex to the opposite
 * edge, and how far across from the next corner to the last one. */
static inline void lmb_cell_part_point(const lmb_cell_part *part, const float u[2], float *along, float *across)
{
    /* A triangle's area from the apex on grows with the square of the way along. */
    *along = sqrtf(part->strip * part->strip + u[0] * (2.0f * part->strip + 1.0f)) / part->strips;
    *across = (part->column + u[1]) / part->columns;
}

/* A point of the cell, likewise, as a hit. */
lmb_hit lmb_cell_point(const lmb_cell *cell, const float u[2]);

/* Square metres. */
float lmb_cell_area(const lmb_cell *cell, const lmb_tracer *tracer);

/* Finds the even triangles and their albedos. */
lmb_result lmb_surface_light_find_albedos(lmb_surface_light *light, const lmb_tracer *tracer, lmb_pool *pool);

/* Once `irradiance` is there: sets `radiance` and, where cells are to be aimed at, finds the bright ones.
 * @return LMB_ERROR_MEMORY */
lmb_result lmb_surface_light_finish(lmb_surface_light *light, const lmb_tracer *tracer, bool aims, lmb_pool *pool);

static inline const lmb_cell_grid *lmb_cell_grid_at(const lmb_surface_light *light, const lmb_hit *hit)
{
    return &light->grid[light->triangle_first[hit->instance] + hit->triangle];
}

/* The albedo of an even triangle at a hit; NULL where its surface takes a closer look. */
static inline const lmb_rgb *lmb_surface_light_albedo(const lmb_surface_light *light, const lmb_hit *hit)
{
    const lmb_cell_grid *grid = lmb_cell_grid_at(light, hit);
    return grid->even ? &light->albedo[grid - light->grid] : NULL;
}

/* Position of the strip or column that `share` in [0, 1] of the way falls into. */
static inline uint32_t lmb_cell_division(float share, uint32_t count)
{
    const float at = share * (float)count;
    return !(at > 0.0f) ? 0 : at < (float)count ? (uint32_t)at : count - 1;
}

/* Index of one side of the cell at a hit. */
static inline uint32_t lmb_surface_light_side(const lmb_surface_light *light, const lmb_hit *hit, bool front)
{
    const lmb_cell_grid *grid = lmb_cell_grid_at(light, hit);
    uint32_t cell = grid->first;
    if (grid->strips * grid->columns > 1) {
        const float weight[5] = {1.0f - hit->u - hit->v, hit->u, hit->v, 1.0f - hit->u - hit->v, hit->u};
        const float along = 1.0f - weight[grid->apex];
        const float across = along > 0.0f ? weight[grid->apex + 2] / along : 0.0f;
        cell += lmb_cell_division(along, grid->strips) * grid->columns + lmb_cell_division(across, grid->columns);
    }
    return 2 * cell + (front ? 0 : 1);
}

/* Has memory fetched that lmb_surface_light_find will look at. */
static inline void lmb_surface_light_prefetch(const lmb_surface_light *light, const lmb_hit *hit)
{
    __builtin_prefetch(lmb_cell_grid_at(light, hit));
}

/* Makes of the side at a hit, `*patch`, the piece that the hit sees; false when it sees the point of none. Adds to
 * `*rays`. */
bool lmb_surface_light_piece_find(const lmb_surface_light *light, const lmb_tracer *tracer, const lmb_hit *hit,
                                  bool front, uint64_t *rays, uint32_t *patch);

/* The patch at a hit; false where there is none. */
static inline bool lmb_surface_light_patch(const lmb_surface_light *light, const lmb_tracer *tracer, const lmb_hit *hit,
                                           bool front, uint64_t *rays, uint32_t *patch)
{
    *patch = lmb_surface_light_side(light, hit, front);
    return !lmb_cell_grid_at(light, hit)->divided ||
           lmb_surface_light_piece_find(light, tracer, hit, front, rays, patch);
}

/* The patch whose `radiance` the surface at a hit sends back along the ray, if it is not uneven. False where that takes
 * a closer look: what is not even, is in no piece, and, when `not_near` is set, what is too near to its cells. */
static inline bool lmb_surface_light_find(const lmb_surface_light *light, const lmb_tracer *tracer, const lmb_hit *hit,
                                          bool not_near, uint64_t *rays, uint32_t *patch)
{
    const lmb_cell_grid *grid = lmb_cell_grid_at(light, hit);
    if (!grid->even || (not_near && hit->distance < lmb_cell_near(grid))) {
        return false;
    }
    return lmb_surface_light_patch(light, tracer, hit, hit->front, rays, patch);
}

#endif
