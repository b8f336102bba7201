#include <lambent/ssbump.h>

#include <math.h>

#include <lambent/rnm.h>
#include <lambent/vector.h>

/* Along one azimuth a height field hides all that is below the highest slope to any of its points, so that a cone's
 * open share is a sum over azimuths of integrals that are known. A multiple of three and of two: the slopes then see
 * the same azimuths, and so does a mirrored map. */
enum { AZIMUTHS = 72, ROWS_PER_TASK = 8 };

/* Slopes below this are not looked for: half a step of 8 bits, where all around is so high. */
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
    float top; /* the highest */
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
    int32_t step;  /* along, +1 or -1 */
    double across; /* for each step */
    double length; /* of a step, texels */
} walk;

/* The height where the walk crosses its `step`-th line, between two texels; false: beyond the border. */
static bool crossing_height(const walk *way, int32_t step, float *height)
{
    const lmb_height_map *map = way->work->map;
    const bool wrap = way->work->settings.wrap;
    const double off = way->across * step, whole = floor(off);
    const float share = (float)(off - whole);
    const int32_t lines = way->columns ? map->width : map->height, side = way->columns ? map->height : map->width;
    const int64_t at = (int64_t)(way->columns ? way->y : way->x) + (int64_t)whole;
    const int32_t line = index_in((int64_t)(way->columns ? way->x : way->y) + (int64_t)way->step * step, lines, wrap);
    const int32_t near_by = index_in(at, side, wrap), beyond = share > 0.0f ? index_in(at + 1, side, wrap) : near_by;
    if (line < 0 || near_by < 0 || beyond < 0) {
        return false;
    }
    const size_t width = (size_t)map->width;
    const size_t first = way->columns ? (size_t)line + width * (size_t)near_by : (size_t)near_by + width * (size_t)line;
    const size_t second = way->columns ? (size_t)line + width * (size_t)beyond : (size_t)beyond + width * (size_t)line;
    *height = map->value[first] + (map->value[second] - map->value[first]) * share;
    return true;
}

/* The steepest slope up to a line, if it is more than `slope`. No farther than where even the highest point of the map
 * would be less steep. */
static float slope_along(const walk *way, float own, float slope)
{
    const float scale = way->work->settings.scale_texels, above = scale * (way->work->top - own);
    float height;
    for (int32_t step = 1;; ++step) {
        const float distance = (float)(way->length * step);
        if (!(above > distance * lmb_larger(slope, LEAST_SLOPE)) || !crossing_height(way, step, &height)) {
            return slope;
        }
        slope = lmb_larger(slope, scale * (height - own) / distance);
    }
}

/* The tangent of the elevation up to which a texel sees nothing along an azimuth. */
static float horizon(const ssbump_work *work, const azimuth *along, int32_t x, int32_t y)
{
    const float own = work->map->value[(size_t)x + (size_t)work->map->width * (size_t)y];
    const double dx = fabs(along->x), dy = fabs(along->y);
    float slope = 0.0f;
    if (dx > 0.0) {
        const walk way = {work, x, y, true, along->x > 0.0 ? 1 : -1, along->y / dx, 1.0 / dx};
        slope = slope_along(&way, own, slope);
    }
    if (dy > 0.0) {
        const walk way = {work, x, y, false, along->y > 0.0 ? 1 : -1, along->x / dy, 1.0 / dy};
        slope = slope_along(&way, own, slope);
    }
    return slope;
}

/* What is left of a wedge above the horizon. */
static float wedge_open(const wedge *of, float slope, float elevation)
{
    return slope <= of->low    ? of->light
           : slope >= of->high ? 0.0f
                               : lmb_larger(of->high_part - part_below(of->across, elevation), 0.0f);
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
        const float slope = horizon(work, along, x, y), elevation = atanf(slope);
        for (int i = 0; i < LMB_RNM_SLOPES; ++i) {
            open[i] += wedge_open(&along->of[i], slope, elevation);
        }
    }
    blend_of_normal(work, x, y, weight);
    for (int i = 0; i < LMB_RNM_SLOPES; ++i) {
        rgb[i] = (uint8_t)(255.0f * lmb_saturate(weight[i] * open[i] / work->light[i]) + 0.5f);
    }
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
    const size_t count = (size_t)map->width * (size_t)map->height;
    for (size_t i = 0; i < count; ++i) {
        work.top = lmb_larger(work.top, map->value[i]);
    }
    azimuths_make(&work);
    lmb_rnm_slopes_in_axes(axes, work.slope);
    const size_t tasks = ((size_t)map->height + ROWS_PER_TASK - 1) / ROWS_PER_TASK;
    return lmb_pool_run(pool, tasks, rows_task, &work, "ssbump", progress);
}
