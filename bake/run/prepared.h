/* What a bake is prepared with, in a file: where its probes stand, which cells are cut, and the light on surfaces. */
#ifndef LMB_PREPARED_H
#define LMB_PREPARED_H

#include <lambent/bake_phases.h>

/* In a folder. */
#define LMB_PREPARED_NAME "prepared.bin"

/* Writes what the phases up to lmb_bake_levels have found. @return LMB_ERROR_WRITE, _MEMORY */
lmb_result lmb_bake_prepared_write(const lmb_bake *bake, const char *directory, lmb_error *error);

/* Whether the folder has such a file, whole, of the bake's key. */
bool lmb_bake_prepared_is_current(const char *directory, uint64_t key);

/* In place of lmb_bake_place, lmb_bake_surface and lmb_bake_levels: their results, bit for bit.
 * @return LMB_ERROR_IO, _FORMAT, _TRUNCATED, _CHECKSUM, _UNSUPPORTED (of another level or other settings), _MEMORY */
lmb_result lmb_bake_prepared_read(lmb_bake *bake, const char *directory, lmb_error *error);

#endif
