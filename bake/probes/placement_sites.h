/* Sites: the points of the finest lattice that the choice of levels looks at, and what it knows of each: whether an
 * object can be there, and a first estimate of the light. */
#ifndef LMB_PLACEMENT_SITES_H
#define LMB_PLACEMENT_SITES_H

#include "probes/placement_internal.h"

#include <lambent/gather_elements.h>

typedef struct lmb_site {
    uint8_t level; /* the coarsest that asked for it: so far apart are its neighbours */
    bool free;     /* an object can be here */
    bool wanted;   /* likewise, and no box says that there are no probes */
    bool lit;      /* what follows is known */
    float validity;
    lmb_vec3 position; /* in the scene, where it was gathered */
    lmb_sh3_rgb light;
    lmb_sh3_rgb difference; /* as lmb_gathered has it: the light's noise */
    float key_visibility[LMB_KEY_LIGHTS_MOST];
} lmb_site;

typedef struct lmb_sites {
    const lmb_transport *transport;
    lmb_pool *pool;
    const lmb_probes *even;  /* one level, of points whose freedom is known */
    uint32_t even_level;     /* its number: its spacing is 2^even_level of the finest */
    bool has_seeds;          /* only what is connected to free points is free; nothing outside of the even box is */
    bool everything_is_free; /* without asking */
    lmb_gather_effort effort;
    const lmb_progress *progress;
    double done, share; /* of all, before the gathering at hand, and its part */
    /* Set by lmb_sites_open. */
    float spacing;      /* the finest */
    lmb_lattice box;    /* of the even level's cells over the level's bounds */
    lmb_lattice bounds; /* of the finest level's */
    lmb_point_set points;
    int32_t known; /* the first ones, of which `site` says all but light */
    lmb_site *site;
    uint64_t rays;
} lmb_sites;

/* Of the fields before. @return LMB_ERROR_UNSUPPORTED: the finest spacing is too fine for the level's size */
lmb_result lmb_sites_open(lmb_sites *sites);
void lmb_sites_close(lmb_sites *sites);

static inline float lmb_sites_spacing(const lmb_sites *sites, uint32_t level)
{
    return sites->spacing * (float)(UINT32_C(1) << level);
}

/* Adds a level's point unless it is there; `lmb_sites_look` is to be called before it is used.
 * @return LMB_ERROR_UNSUPPORTED (too many), _MEMORY */
lmb_result lmb_sites_add(lmb_sites *sites, uint32_t level, const int32_t point[3]);

/* Finds out which of the added sites are free. A site of a level finer than the even one is reached, where there are
 * seeds, when one of the points around it on the next coarser level is free and sees it.
 * @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result lmb_sites_look(lmb_sites *sites);

/* Whether a level's cell reaches into the level's bounds, or a point is within them. */
bool lmb_sites_cell_counts(const lmb_sites *sites, uint32_t level, const int32_t cell[3]);
bool lmb_sites_point_counts(const lmb_sites *sites, uint32_t level, const int32_t point[3]);

/* The site of a level's point, or NULL. */
lmb_site *lmb_sites_find(const lmb_sites *sites, uint32_t level, const int32_t point[3]);

/* Gathers at a list, as for sites. @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result lmb_sites_gather(lmb_sites *sites, const lmb_gather_list *list, lmb_gathered *gathered);

/* Gathers light at those of the `count` sites, by number and in this order, that are free and have none.
 * @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result lmb_sites_light(lmb_sites *sites, const int32_t *number, size_t count);

#endif
