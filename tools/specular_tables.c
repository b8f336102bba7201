/* Writes the tables of the area specular: lambent_specular_tables sampler/specular_tables.h
 *
 * The lobe of Cook and Torrance times the cosine, projected on the harmonics that the mirror symmetry leaves, about the
 * normal z with the view in the plane of x and z (Chen and Liu 2008, section 1.4.3.3): C with the Fresnel factor left
 * out, D with Schlick's (1 - L.H)^5. Odd powers of the view's sine are divided out, so that what is stored is smooth
 * where the view passes the normal, and no frame is needed there. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <lambent/specular.h>
#include <lambent/vector.h>

enum { ROUGHNESSES = LMB_SPECULAR_ROWS, VIEWS = LMB_SPECULAR_COLUMNS, BASES = 6, VALUES = 2 * BASES };

/* Steps over the slope of the half vector and its azimuth. */
enum { SLOPES = 1024, AZIMUTHS = 512 };

/* Values lie between -2 and 2. */
#define VALUE_SCALE 16384.0

/* The sines at which the limit of a view along the normal is taken: values are even in them. */
#define NEAR_SINE 0.1
#define FAR_SINE 0.2

typedef struct lobe {
    double value[VALUES]; /* C, then D */
} lobe;

/* Y of 00, 10, 11, 20, 21 and 22 without their signs: what is towards the view's side is positive. */
static void bases(double x, double y, double z, double basis[BASES])
{
    basis[0] = 0.5 / sqrt(LMB_PI);
    basis[1] = sqrt(0.75 / LMB_PI) * z;
    basis[2] = sqrt(0.75 / LMB_PI) * x;
    basis[3] = sqrt(0.3125 / LMB_PI) * (3.0 * z * z - 1.0);
    basis[4] = sqrt(3.75 / LMB_PI) * x * z;
    basis[5] = sqrt(0.9375 / LMB_PI) * (x * x - y * y);
}

/* Adds what the half vector h sends from light to view. Half vectors are picked in proportion to D (N.H), which leaves
 * G (V.H) / ((N.V) (N.H)) of the lobe, with G the least of 1, 2 (N.H)(N.V)/(V.H) and 2 (N.H)(N.L)/(V.H). */
static void half_vector_add(const double h[3], double sine, double cosine, double weight, lobe *sum)
{
    const double along = sine * h[0] + cosine * h[2];
    const double light[3] = {2.0 * along * h[0] - sine, 2.0 * along * h[1], 2.0 * along * h[2] - cosine};
    if (!(along > 0.0 && light[2] > 0.0)) {
        return;
    }
    double arrives = fmin(2.0, along / (cosine * h[2]));
    arrives = weight * fmin(arrives, 2.0 * light[2] / cosine);
    const double schlick = pow(1.0 - along, 5.0);
    double basis[BASES];
    bases(light[0], light[1], light[2], basis);
    for (int i = 0; i < BASES; ++i) {
        sum->value[i] += arrives * basis[i];
        sum->value[BASES + i] += arrives * schlick * basis[i];
    }
}

/* Beckmann's slopes t have the density exp(-t^2/m^2) 2t/m^2. */
static lobe lobe_integrate(double roughness, double sine)
{
    lobe sum = {{0.0}};
    const double cosine = fmax(sqrt((1.0 - sine) * (1.0 + sine)), 1e-9);
    for (int i = 0; i < SLOPES; ++i) {
        const double slope = roughness * sqrt(-log(1.0 - (i + 0.5) / SLOPES));
        const double up = 1.0 / sqrt(1.0 + slope * slope);
        for (int j = 0; j < AZIMUTHS; ++j) {
            const double turn = LMB_PI * (j + 0.5) / AZIMUTHS; /* the other half is its mirror image */
            const double h[3] = {up * slope * cos(turn), up * slope * sin(turn), up};
            half_vector_add(h, sine, cosine, 1.0 / ((double)SLOPES * AZIMUTHS), &sum);
        }
    }
    return sum;
}

/* A mirror's lobe is the basis at the mirrored view. */
static lobe lobe_of_mirror(double sine)
{
    const double cosine = sqrt((1.0 - sine) * (1.0 + sine));
    lobe mirrored;
    bases(-sine, 0.0, cosine, mirrored.value);
    for (int i = 0; i < BASES; ++i) {
        mirrored.value[BASES + i] = pow(1.0 - cosine, 5.0) * mirrored.value[i];
    }
    return mirrored;
}

/* With the powers of the view's sine divided out; on the other side of the normal, light comes from x < 0. */
static lobe lobe_reduced(double roughness, double sine)
{
    const double power[BASES] = {1.0, 1.0, -sine, 1.0, -sine, sine * sine};
    lobe found = roughness > 0.0 ? lobe_integrate(roughness, sine) : lobe_of_mirror(sine);
    for (int i = 0; i < VALUES; ++i) {
        found.value[i] /= power[i % BASES];
    }
    return found;
}

static lobe lobe_at_normal(double roughness)
{
    const double near_square = NEAR_SINE * NEAR_SINE, far_square = FAR_SINE * FAR_SINE;
    const lobe close = lobe_reduced(roughness, NEAR_SINE), away = lobe_reduced(roughness, FAR_SINE);
    lobe found;
    for (int i = 0; i < VALUES; ++i) {
        found.value[i] = (far_square * close.value[i] - near_square * away.value[i]) / (far_square - near_square);
    }
    return found;
}

/* Node i has sqrt(m) = i/15, node j has (c + sqrt(c))/2 = j/7 of the cosine c of the view: closer together where lobes
 * change faster. */
static lobe lobe_of_node(int i, int j)
{
    const double root = (double)i / (ROUGHNESSES - 1);
    const double cosine_root = 0.5 * (sqrt(1.0 + 8.0 * j / (VIEWS - 1)) - 1.0);
    const double cosine = cosine_root * cosine_root;
    return j == VIEWS - 1 ? lobe_at_normal(root * root)
                          : lobe_reduced(root * root, sqrt((1.0 - cosine) * (1.0 + cosine)));
}

typedef int16_t tables[ROUGHNESSES][VIEWS][VALUES];

static void tables_make(tables made)
{
    for (int i = 0; i < ROUGHNESSES; ++i) {
        for (int j = 0; j < VIEWS; ++j) {
            const lobe found = lobe_of_node(i, j);
            for (int k = 0; k < VALUES; ++k) {
                made[i][j][k] = (int16_t)floor(found.value[k] * VALUE_SCALE + 0.5);
            }
        }
    }
}

static void header_write(FILE *file, const tables made)
{
    fprintf(
        file,
        "/* Written by lambent_specular_tables: lobes of Cook and Torrance in harmonics (docs/maths.md). */\n"
        "#ifndef LMB_SPECULAR_TABLES_H\n#define LMB_SPECULAR_TABLES_H\n\n#include <stdint.h>\n\n"
        "#include <lambent/specular.h>\n\nenum { LMB_SPECULAR_VALUES = %d };\n\n"
        "/* [roughness][view][C of 00, 10, 11, 20, 21, 22, then D], times %g. */\n"
        "static const int16_t lmb_specular_table[LMB_SPECULAR_ROWS][LMB_SPECULAR_COLUMNS][LMB_SPECULAR_VALUES] = {\n",
        VALUES, VALUE_SCALE);
    for (int i = 0; i < ROUGHNESSES; ++i) {
        for (int j = 0; j < VIEWS; ++j) {
            fprintf(file, "%s", j == 0 ? "    {{" : "     {");
            for (int k = 0; k < VALUES; ++k) {
                fprintf(file, k + 1 < VALUES ? "%d, " : "%d", made[i][j][k]);
            }
            fprintf(file, "%s\n", j + 1 < VIEWS ? "}," : "}},");
        }
    }
    fprintf(file, "};\n\n#endif\n");
}

int main(int count, char **values)
{
    static tables made;
    if (count != 2) {
        fprintf(stderr, "usage: lambent_specular_tables FILE\n");
        return 2;
    }
    tables_make(made);
    FILE *const file = fopen(values[1], "w");
    if (file) {
        header_write(file, made);
    }
    if (!file || ferror(file) || fclose(file) != 0) {
        fprintf(stderr, "lambent_specular_tables: %s cannot be written\n", values[1]);
        return 1;
    }
    return 0;
}
