#include <lambent/ssbump.h>

#include <math.h>
#include <stdlib.h>

#include <lambent/rnm.h>
#include <lambent/vector.h>

/* Along one azimuth a height field hides all that is below the highest slope to any of its points, so that a cone's
 * open share is a sum over azimuths of integrals that are known. A multiple of three and of two: the slopes then see
 * the same azimuths, and so does a mirrored map. */
enum { AZIMUTHS = 72, ROWS_PER_TASK = 8, CELL = 8 };

/* Slopes up to this count as flat: half a step of 8 bits, where all around is so high. */
#define LEAST_SLOPE (1.0f / 128.0f)

/* The part of one slope's cone over one azimuth: elevations e from `low` to `high`, as tangents. With
 * D.B = a cos e + UP sin e its light is a P + UP Q, P = (e + sin e cos e)/2, Q = (sin^2 e)/2, taken from low to high.
 */
typedef struct wedge {
    float low, high;
    float across;    /* a */
    float light;     /* of all of it */
    float high_part; /* a P + UP Q at `high` */
} wedge;

#define UP 0.57735027f

typedef struct azimuth {
    double x, y; /* texels; y downwards */
    wedge of[LMB_RNM_SLOPES];
} azimuth;

typedef struct ssbump_work {
    const lmb_height_map *map;
    lmb_ssbump_settings settings;
    float top;     /* the highest */
    float *around; /* [cell] the highest in a square of CELL texels and within CELL of it */
    size_t cells;  /* in a row */
    azimuth azimuth[AZIMUTHS];
    lmb_vec3 slope[LMB_RNM_SLOPES];
    float light[LMB_RNM_SLOPES]; /* of all azimuths */
    uint8_t *rgb;
} ssbump_work;

lmb_ssbump_settings lmb_ssbump_settings_default(void)
{
    return (lmb_ssbump_settings){.scale_texels = 16.0f};
}

static float part_below(float across, float elevation)
{
    const float s = sinf(elevation);
    return 0.5f * (across * (elevation + s * cosf(elevation)) + UP * s * s);
}

/* D.B = R cos(e - m) is at least 1/2, the cosine of half of 120 degrees, for |e - m| <= acos(1/(2R)). */
static wedge wedge_of(double across)
{
    const double up = sqrt(1.0 / 3.0), middle = atan2(up, across);
    const double half = acos(0.5 / sqrt(across * across + up * up));
    const double low = fmax(middle - half, 0.0), high = fmin(middle + half, 0.5 * LMB_PI);
    wedge made = {.low = (float)tan(low), .high = high < 0.5 * LMB_PI ? (float)tan(high) : INFINITY};
    made.across = (float)across;
    made.high_part = part_below(made.across, (float)high);
    made.light = made.high_part - part_below(made.across, (float)low);
    return made;
}

static void azimuths_make(ssbump_work *work)
{
    for (int k = 0; k < AZIMUTHS; ++k) {
        const double turn = 2.0 * LMB_PI * k / AZIMUTHS;
        azimuth *made = &work->azimuth[k];
        /* Along the axes exactly: a crossing there is a texel. */
        made->x = k % (AZIMUTHS / 2) == AZIMUTHS / 4 ? 0.0 : cos(turn);
        made->y = k % (AZIMUTHS / 2) == 0 ? 0.0 : -sin(turn);
        for (int i = 0; i < LMB_RNM_SLOPES; ++i) {
            made->of[i] = wedge_of(sqrt(2.0 / 3.0) * cos(turn - 2.0 * LMB_PI * i / LMB_RNM_SLOPES));
            work->light[i] += made->of[i].light;
        }
    }
}

/* `i` of a row or column of `count`: the other side's with wrap; -1 beyond the border without. */
static int32_t index_in(int64_t i, int32_t count, bool wrap)
{
    if (i >= 0 && i < count) {
        return (int32_t)i;
    }
    return wrap ? (int32_t)((i % count + count) % count) : -1;
}

/* Walks one way across the map, from line to line of texels. */
typedef struct walk {
    const ssbump_work *work;
    int32_t x, y;  /* from here */
    bool columns;  /* lines are columns; else rows */
    int32_t sign;  /* along, +1 or -1 */
    double across; /* for each step */
    double length; /* of a step, texels */
    int32_t leap;  /* so many steps stay within CELL texels of where they begin */
} walk;

static walk walk_of(const ssbump_work *work, int32_t x, int32_t y, bool columns, const azimuth *along)
{
    const double forth = columns ? along->x : along->y, aside = columns ? along->y : along->x;
    const double across = aside / fabs(forth);
    return (walk){work,
                  x,
                  y,
                  columns,
                  forth > 0.0 ? 1 : -1,
                  across,
                  1.0 / fabs(forth),
                  (int32_t)((CELL - 1) / fmax(fabs(across), 1.0))};
}

/* Where a walk crosses a line, between two texels. */
typedef struct crossing {
    int32_t x[2], y[2];
    float share; /* of the second */
} crossing;

/* False: beyond the border. */
static bool crossing_find(const walk *way, int32_t step, crossing *found)
{
    const lmb_height_map *map = way->work->map;
    const bool wrap = way->work->settings.wrap;
    const double off = way->across * step;
    const int64_t whole = (int64_t)off - (off < 0.0); /* on a whole number the second texel is the one */
    const int32_t lines = way->columns ? map->width : map->height, side = way->columns ? map->height : map->width;
    const int64_t at = (int64_t)(way->columns ? way->y : way->x) + whole;
    const int32_t line = index_in((int64_t)(way->columns ? way->x : way->y) + (int64_t)way->sign * step, lines, wrap);
    found->share = (float)(off - (double)whole);
    for (int i = 0; i < 2; ++i) {
        const int32_t beside = index_in(at + (found->share > 0.0f ? i : 0), side, wrap);
        found->x[i] = way->columns ? line : beside;
        found->y[i] = way->columns ? beside : line;
        if (line < 0 || beside < 0) {
            return false;
        }
    }
    return true;
}

static float crossing_height(const lmb_height_map *map, const crossing *at)
{
    const float first = map->value[(size_t)at->x[0] + (size_t)map->width * (size_t)at->y[0]];
    const float second = map->value[(size_t)at->x[1] + (size_t)map->width * (size_t)at->y[1]];
    return first + (second - first) * at->share;
}

/* The highest point within CELL texels of a crossing, or more. */
static float highest_around(const ssbump_work *work, const crossing *at)
{
    return work->around[(size_t)(at->x[0] / CELL) + work->cells * (size_t)(at->y[0] / CELL)];
}

/* The steepest slope up to a line, if it is more than `slope`. No farther than where even the highest point of the map
 * would be less steep, and over places where all around is. */
static float slope_along(const walk *way, float own, float slope)
{
    const float scale = way->work->settings.scale_texels, above = scale * (way->work->top - own);
    for (int32_t step = 1;;) {
        const float distance = (float)(way->length * step), higher = distance * slope;
        crossing at;
        if (!(above > higher) || !crossing_find(way, step, &at)) {
            return slope;
        }
        if (way->leap > 1 && step % way->leap == 1 && !(scale * (highest_around(way->work, &at) - own) > higher)) {
            step += way->leap;
            continue;
        }
        slope = lmb_larger(slope, scale * (crossing_height(way->work->map, &at) - own) / distance);
        ++step;
    }
}

/* The tangent of the elevation up to which a texel sees nothing along an azimuth. */
static float horizon(const ssbump_work *work, const azimuth *along, int32_t x, int32_t y)
{
    const float own = work->map->value[(size_t)x + (size_t)work->map->width * (size_t)y];
    float slope = LEAST_SLOPE;
    for (int columns = 0; columns < 2; ++columns) {
        if ((columns ? along->x : along->y) != 0.0) {
            const walk way = walk_of(work, x, y, columns, along);
            slope = slope_along(&way, own, slope);
        }
    }
    return slope > LEAST_SLOPE ? slope : 0.0f;
}

/* P and Q of a horizon, in terms of its tangent. */
typedef struct below_horizon {
    float slope, p, q;
} below_horizon;

static below_horizon below_horizon_of(float slope)
{
    const float square = 1.0f / (1.0f + slope * slope);
    return (below_horizon){slope, 0.5f * (atanf(slope) + slope * square), 0.5f * slope * slope * square};
}

/* What is left of a wedge above it. */
static float wedge_open(const wedge *of, const below_horizon *below)
{
    return below->slope <= of->low    ? of->light
           : below->slope >= of->high ? 0.0f
                                      : lmb_larger(of->high_part - of->across * below->p - UP * below->q, 0.0f);
}

static float height_at(const ssbump_work *work, int32_t x, int32_t y)
{
    const lmb_height_map *map = work->map;
    const int32_t column = index_in(x, map->width, work->settings.wrap),
                  row = index_in(y, map->height, work->settings.wrap);
    const int32_t inside_x = column >= 0 ? column : x < 0 ? 0 : map->width - 1;
    const int32_t inside_y = row >= 0 ? row : y < 0 ? 0 : map->height - 1;
    return work->settings.scale_texels * map->value[(size_t)inside_x + (size_t)map->width * (size_t)inside_y];
}

/* The blend of a normal map: squared cosines over their sum. */
static void blend_of_normal(const ssbump_work *work, int32_t x, int32_t y, float weight[LMB_RNM_SLOPES])
{
    const lmb_vec3 normal = {0.5f * (height_at(work, x - 1, y) - height_at(work, x + 1, y)),
                             0.5f * (height_at(work, x, y + 1) - height_at(work, x, y - 1)), 1.0f};
    float total = 0.0f;
    for (int i = 0; i < LMB_RNM_SLOPES; ++i) {
        const float cosine = lmb_larger(lmb_vec3_dot(normal, work->slope[i]), 0.0f);
        weight[i] = cosine * cosine;
        total += weight[i];
    }
    for (int i = 0; i < LMB_RNM_SLOPES; ++i) {
        weight[i] /= total;
    }
}

static void texel_make(const ssbump_work *work, int32_t x, int32_t y, uint8_t rgb[LMB_RNM_SLOPES])
{
    float open[LMB_RNM_SLOPES] = {0.0f}, weight[LMB_RNM_SLOPES];
    for (int k = 0; k < AZIMUTHS; ++k) {
        const azimuth *along = &work->azimuth[k];
        const below_horizon below = below_horizon_of(horizon(work, along, x, y));
        for (int i = 0; i < LMB_RNM_SLOPES; ++i) {
            open[i] += wedge_open(&along->of[i], &below);
        }
    }
    blend_of_normal(work, x, y, weight);
    for (int i = 0; i < LMB_RNM_SLOPES; ++i) {
        rgb[i] = (uint8_t)(255.0f * lmb_saturate(weight[i] * open[i] / work->light[i]) + 0.5f);
    }
}

/* The highest of the cell that begins there and of what is within CELL texels of it. */
static float highest_about(const ssbump_work *work, int32_t first_x, int32_t first_y)
{
    const lmb_height_map *map = work->map;
    float highest = 0.0f;
    for (int32_t y = first_y - CELL; y < first_y + 2 * CELL; ++y) {
        const int32_t row = index_in(y, map->height, work->settings.wrap);
        for (int32_t x = first_x - CELL; row >= 0 && x < first_x + 2 * CELL; ++x) {
            const int32_t column = index_in(x, map->width, work->settings.wrap);
            if (column >= 0) {
                highest = lmb_larger(highest, map->value[(size_t)column + (size_t)map->width * (size_t)row]);
            }
        }
    }
    return highest;
}

static bool heights_make(ssbump_work *work)
{
    const lmb_height_map *map = work->map;
    work->cells = ((size_t)map->width + CELL - 1) / CELL;
    const size_t rows = ((size_t)map->height + CELL - 1) / CELL;
    work->around = malloc(work->cells * rows * sizeof *work->around);
    for (size_t i = 0; work->around && i < work->cells * rows; ++i) {
        work->around[i] = highest_about(work, (int32_t)(i % work->cells) * CELL, (int32_t)(i / work->cells) * CELL);
        work->top = lmb_larger(work->top, work->around[i]);
    }
    return work->around != NULL;
}

static void rows_task(void *context, size_t task, int worker)
{
    (void)worker;
    const ssbump_work *work = context;
    const int32_t first = (int32_t)task * ROWS_PER_TASK, width = work->map->width;
    for (int32_t y = first; y < first + ROWS_PER_TASK && y < work->map->height; ++y) {
        for (int32_t x = 0; x < width; ++x) {
            texel_make(work, x, y, &work->rgb[LMB_RNM_SLOPES * ((size_t)x + (size_t)width * (size_t)y)]);
        }
    }
}

lmb_result lmb_ssbump_make(const lmb_height_map *map, const lmb_ssbump_settings *settings, lmb_pool *pool,
                           const lmb_progress *progress, uint8_t *rgb)
{
    static const lmb_vec3 axes[3] = {{1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}};
    ssbump_work work = {.map = map, .settings = *settings, .rgb = rgb};
    if (!heights_make(&work)) {
        return LMB_ERROR_MEMORY;
    }
    azimuths_make(&work);
    lmb_rnm_slopes_in_axes(axes, work.slope);
    const size_t tasks = ((size_t)map->height + ROWS_PER_TASK - 1) / ROWS_PER_TASK;
    const lmb_result result = lmb_pool_run(pool, tasks, rows_task, &work, "ssbump", progress);
    free(work.around);
    return result;
}
