/* The local sets of a .lmb file (lambent/volume_format.h), as C structs: for those who write one. docs/formats.md is
 * normative.
 *
 *     lmb_volume_locals | an lmb_volume_local for each set | names | probes
 *
 * The names are NUL-terminated, one behind the other, filled up with zeros to a multiple of 4 bytes. The probes, in the
 * form of the volume's, are those of the first set, then of the second, ..., each set's with x fastest. */
#ifndef LAMBENT_LOCAL_SET_FORMAT_H
#define LAMBENT_LOCAL_SET_FORMAT_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_volume_locals {
    uint32_t count;      /* of sets, >= 1 */
    uint32_t name_bytes; /* of all names; a multiple of 4, the last byte is 0 */
} lmb_volume_locals;

typedef struct lmb_volume_local {
    double origin[3]; /* lmb_local_frame */
    float step[3][3];
    uint32_t size[3];
    int32_t node, place;  /* lmb_local_set */
    uint32_t name;        /* where its name begins among the names */
    uint32_t probe_first; /* of all sets' probes: as many as the sets before have */
    uint32_t reserved[2];
} lmb_volume_local;

#ifdef __cplusplus
}
#endif

#endif
