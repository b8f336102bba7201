/* Lights a bumpy sphere in a baked volume the cheap way, and says what that costs and how far it is from the dear one:
 *
 *     vertex_path FILE.lmb
 *
 * For each vertex: SH3 from the volume, to what its hemisphere lets through as SH2 by the oriented multiply, to a
 * hemisphere light and one direction, to IrradZ: seven numbers, which a rasteriser interpolates, each by itself. For
 * each pixel they are decoded and evaluated on the shading normal (Roughton et al., SIGGRAPH 2024). Dear is all of it
 * for each pixel. */
#include <math.h>
#include <stdio.h>
#include <time.h>

#include <lambent/hhd.h>
#include <lambent/volume.h>

enum { MOST_SIDE = 48, PIXELS_ACROSS = 6 };

/* The sphere as a grid: `side` quads around and half as many from pole to pole. */
typedef struct sphere {
    lmb_vec3d middle;
    double radius;
} sphere;

static lmb_vec3 normal_at(double u, double v)
{
    const double turn = 6.283185307179586 * u, down = 3.141592653589793 * v;
    return lmb_vec3_of((float)(sin(down) * cos(turn)), (float)cos(down), (float)(sin(down) * sin(turn)));
}

static lmb_irradz light_at(const lmb_volume *volume, const sphere *ball, lmb_vec3 n_v)
{
    const lmb_vec3d at = {ball->middle.x + ball->radius * (double)n_v.x, ball->middle.y + ball->radius * (double)n_v.y,
                          ball->middle.z + ball->radius * (double)n_v.z};
    lmb_sh3_rgb radiance;
    lmb_volume_sample_at(volume, at, &radiance);
    return lmb_irradz_encode(&radiance, n_v, 0.0f);
}

/* What a normal map does. */
static lmb_vec3 bumped(lmb_vec3 n_v, double u, double v)
{
    const lmb_vec3 bump = {0.4f * (float)sin(190.0 * u), 0.4f * (float)cos(170.0 * v),
                           0.4f * (float)sin(130.0 * (u + v))};
    return lmb_vec3_unit_or(lmb_vec3_add(n_v, bump), n_v);
}

static void add_scaled(lmb_irradz *sum, const lmb_irradz *vertex, float weight)
{
    sum->irradiance_z = lmb_rgb_add(sum->irradiance_z, lmb_rgb_scale(vertex->irradiance_z, weight));
    sum->ambient_weight += weight * vertex->ambient_weight;
    sum->direction = lmb_vec3_mad(sum->direction, vertex->direction, weight);
}

static void vertices_light(const lmb_volume *volume, const sphere *ball, int side, lmb_irradz *vertex)
{
    for (int row = 0; row <= side / 2; ++row) {
        for (int column = 0; column <= side; ++column) {
            vertex[column + (side + 1) * row] =
                light_at(volume, ball, normal_at((double)column / side, 2.0 * row / side));
        }
    }
}

/* The pixel at (u, v) between its quad's vertices. */
static lmb_rgb pixel_light(const lmb_irradz *vertex, int side, double u, double v, lmb_vec3 n_v, lmb_vec3 n)
{
    const double x = u * side, y = 0.5 * v * side;
    const int column = (int)x, row = (int)y;
    const float across = (float)(x - column), down = (float)(y - row);
    const lmb_irradz *corner = &vertex[column + (side + 1) * row];
    lmb_irradz mean = {{{0.0f, 0.0f, 0.0f}}, 0.0f, {0.0f, 0.0f, 0.0f}};
    add_scaled(&mean, &corner[0], (1.0f - across) * (1.0f - down));
    add_scaled(&mean, &corner[1], across * (1.0f - down));
    add_scaled(&mean, &corner[side + 1], (1.0f - across) * down);
    add_scaled(&mean, &corner[side + 2], across * down);
    return lmb_irradz_evaluate(&mean, n_v, n);
}

static double nanoseconds_since(clock_t start, double count)
{
    return 1e9 * (double)(clock() - start) / CLOCKS_PER_SEC / count;
}

enum { MOST_PIXELS = MOST_SIDE * MOST_SIDE / 2 * PIXELS_ACROSS * PIXELS_ACROSS };
static struct {
    lmb_vec3 n_v, n;
    lmb_rgb cheap, dear;
} pixel[MOST_PIXELS];

/* One line: a tessellation, its error relative to lighting each pixel, and nanoseconds a vertex, a pixel of either way.
 */
static void tessellation_measure(const lmb_volume *volume, const sphere *ball, int side)
{
    static lmb_irradz vertex[(MOST_SIDE + 1) * (MOST_SIDE / 2 + 1)];
    const int columns = side * PIXELS_ACROSS, rows = side / 2 * PIXELS_ACROSS, pixels = columns * rows;
    double error = 0.0, light = 0.0;
    for (int i = 0; i < pixels; ++i) {
        const int column = i % columns, row = i / columns;
        const double u = (column + 0.5) / columns, v = (row + 0.5) / rows;
        pixel[i].n_v = normal_at(u, v);
        pixel[i].n = bumped(pixel[i].n_v, u, v);
    }
    clock_t start = clock();
    vertices_light(volume, ball, side, vertex);
    const int vertices = (side + 1) * (side / 2 + 1);
    const double vertex_cost = nanoseconds_since(start, vertices);
    start = clock();
    for (int i = 0; i < pixels; ++i) {
        const int column = i % columns, row = i / columns;
        const double u = (column + 0.5) / columns, v = (row + 0.5) / rows;
        pixel[i].cheap = pixel_light(vertex, side, u, v, pixel[i].n_v, pixel[i].n);
    }
    const double cheap_cost = nanoseconds_since(start, pixels);
    start = clock();
    for (int i = 0; i < pixels; ++i) {
        const lmb_irradz own = light_at(volume, ball, pixel[i].n_v);
        pixel[i].dear = lmb_irradz_evaluate(&own, pixel[i].n_v, pixel[i].n);
    }
    const double dear_cost = nanoseconds_since(start, pixels);
    for (int i = 0; i < pixels; ++i) {
        for (int c = 0; c < 3; ++c) {
            const double dear = (double)pixel[i].dear.c[c], off = (double)pixel[i].cheap.c[c] - dear;
            error += off * off;
            light += dear * dear;
        }
    }
    printf("%2d x %2d vertices: %6.3f %% off; %.0f ns a vertex, %.0f ns a pixel; all of it for each pixel %.0f ns\n",
           side, side / 2, 100.0 * sqrt(error / fmax(light, 1e-30)), vertex_cost, cheap_cost, dear_cost);
}

int main(int count, char **values)
{
    lmb_volume *volume;
    const lmb_result opened = count == 2 ? lmb_volume_open_file(values[1], &volume) : LMB_ERROR_ARGUMENT;
    if (opened != LMB_OK) {
        fprintf(stderr, "vertex_path: %s: %s\n", count == 2 ? values[1] : "FILE.lmb", lmb_result_text(opened));
        return 1;
    }
    const lmb_volume_info info = lmb_volume_get_info(volume);
    const lmb_vec3d low = info.bounds_min, high = info.bounds_max;
    const lmb_vec3d middle = {0.5 * (low.x + high.x), 0.5 * (low.y + high.y), 0.5 * (low.z + high.z)};
    const sphere ball = {middle, (double)lmb_volume_spacing_at(volume, middle)};
    for (int side = 6; side <= MOST_SIDE; side *= 2) {
        tessellation_measure(volume, &ball, side);
    }
    lmb_volume_close(volume);
    return 0;
}
