/* Values in memory, one after the other, as a file keeps them between machines of one kind. What names the values in
 * their order writes them or reads them, whichever `reads` says. */
#ifndef LMB_STORED_H
#define LMB_STORED_H

#include <stdbool.h>
#include <stddef.h>

#include <lambent/error.h>

typedef struct lmb_stored {
    bool reads;
    unsigned char *data; /* written: freed by lmb_stored_free; read: the caller's */
    size_t size;         /* bytes written, or that there are to read */
    size_t room;         /* written */
    size_t at;           /* read */
    lmb_result result;   /* what went wrong first: LMB_ERROR_MEMORY, _TRUNCATED, _FORMAT */
} lmb_stored;

/* To be read. Writing begins with all zero. */
lmb_stored lmb_stored_of(unsigned char *data, size_t size);

/* Frees what was written. */
void lmb_stored_free(lmb_stored *stored);

/* Writes or reads a value; what cannot be read is zero. */
void lmb_stored_value(lmb_stored *stored, void *value, size_t size);

/* The same for one without padding, by its name. */
#define LMB_STORED(stored, value) lmb_stored_value(stored, &(value), sizeof(value))

/* Values one after the other. Reading allocates them, with room for one more: the caller's; NULL on failure. */
void *lmb_stored_array(lmb_stored *stored, void *values, size_t count, size_t size);

/* Reading, what does not hold is LMB_ERROR_FORMAT. @return whether all is good so far */
bool lmb_stored_expect(lmb_stored *stored, bool holds);

#endif
