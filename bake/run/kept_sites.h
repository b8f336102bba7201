/* Which elements of two bakes are the same, and which lie in a box. */
#ifndef LMB_KEPT_SITES_H
#define LMB_KEPT_SITES_H

#include <lambent/bake_level.h>
#include <lambent/gather_elements.h>

/* Where the elements of a list are gathered at. */
typedef struct lmb_kept_sites {
    size_t count;
    uint64_t *hash;  /* [element] of the points, in the world, and of how light is gathered there */
    uint8_t *inside; /* [element] whether any of its points is in the box */
} lmb_kept_sites;

/* Looks at all of them; adds rays, and how many were moved, to `stats`. Box: its least and its greatest coordinates.
 * @return LMB_ERROR_MEMORY; then there is nothing to free */
lmb_result lmb_kept_sites_find(const lmb_gather_list *list, const lmb_level *level, const lmb_vec3d box[2],
                               lmb_kept_sites *sites, lmb_gather_stats *stats);
void lmb_kept_sites_free(lmb_kept_sites *sites);

/* same[element]: the one of another list, of which there are the hashes, that is gathered at the same site; or
 * LMB_KEPT_NOT_THERE. Of several at one site the first is the first, and so on. `other` need not be aligned.
 * @return LMB_ERROR_MEMORY */
#define LMB_KEPT_NOT_THERE SIZE_MAX
lmb_result lmb_kept_sites_match(const lmb_kept_sites *sites, const void *other, size_t other_count, size_t *same);

#endif
