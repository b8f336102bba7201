/* Probes as little spheres in a picture, each lit by what it holds. */
#ifndef LMB_TOOLS_PROBE_SPHERES_H
#define LMB_TOOLS_PROBE_SPHERES_H

#include <stdbool.h>

#include <lambent/probes.h>

/* Radii, and how far a ghost lies from its point, in spacings of the level. */
#define PROBE_SPHERE_RADIUS 0.1
#define GHOST_SPHERE_RADIUS 0.05
#define GHOST_SPHERE_DISTANCE 0.25

typedef struct probe_spheres {
    const lmb_probes *probes;
    lmb_probe_index *first_ghost; /* [level] the first ghost of a point, counted from the first of all */
    int32_t *next_ghost;          /* [ghost] the next one of its point, or -1 */
    lmb_vec3d *shift;             /* [ghost] spacings from its point, towards the regions that it stands for */
} probe_spheres;

/* `probes` must outlive it. @return LMB_ERROR_MEMORY */
lmb_result probe_spheres_make(const lmb_probes *probes, probe_spheres *spheres);
void probe_spheres_free(probe_spheres *spheres);

/* The nearest sphere along a ray of the world, with a unit direction, farther than `start` and nearer than `*distance`,
 * which then is its distance. The colour is that of white paper in the probe's light; probes that were not baked have a
 * red belt, ghosts a blue one, others of local sets a green one. */
bool probe_spheres_nearest(const probe_spheres *spheres, lmb_vec3d origin, lmb_vec3 direction, float start,
                           float *distance, lmb_rgb *colour);

#endif
