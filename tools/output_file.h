/* Where a command writes one file. */
#ifndef LMB_TOOLS_OUTPUT_FILE_H
#define LMB_TOOLS_OUTPUT_FILE_H

#include <stdbool.h>

#include <lambent/error.h>

/* Whether a file can be written, found before there is anything to write. An interruption while it is written leaves
 * none of it. @return LMB_ERROR_WRITE, _MEMORY */
lmb_result output_file_check(const char *path, lmb_error *error);

/* Whether a file's name has an ending such as ".png", and more before it. */
bool output_file_ends_in(const char *path, const char *ending);

#endif
