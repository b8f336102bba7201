#ifndef LMB_BAKE_RECORD_INTERNAL_H
#define LMB_BAKE_RECORD_INTERNAL_H

#include <cjson/cJSON.h>

#include <lambent/bake_record.h>

/* What bake.json says of the bake; takes `files` and their `hashes` (NULL: leaves them out). */
cJSON *lmb_bake_record_json(const lmb_bake_record *record, cJSON *files, cJSON *hashes);

#endif
