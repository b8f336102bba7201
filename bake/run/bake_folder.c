#define _DEFAULT_SOURCE /* flock */
#include "run/bake_folder_internal.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <lambent/file.h>

#include "run/kept.h"
#include "run/parts.h"

#define LOCK_NAME ".lambent-lock"
#define NEW_NAME ".lambent-new"
#define OLD_NAME ".lambent-old"
#define GONE_NAME ".lambent-gone" /* what was new, while lmb_bake_folder_abandon removes it */
#define RECORD_NAME "bake.json"
#define LIGHTMAP_NAME "lightmap"

enum { MAX_PATH = 4096, MAX_NAME = 512, MAX_DEPTH = 4 };

/* A file's way from the old bake to the new one. */
typedef struct file_change {
    char name[MAX_NAME];
    bool is_new; /* the new bake has it */
    bool kept;   /* its old version lies in OLD_NAME */
    bool placed; /* its new version is in its place */
} file_change;

struct lmb_bake_folder {
    char directory[MAX_PATH];
    size_t made_from; /* length of the shortest part of `directory` that was made here; 0: none */
    bool lightmaps;
    int lock; /* descriptor; -1: not taken */
    char stage[MAX_PATH];
    file_change *changes; /* of the earlier bakes' files, then of the new ones */
    size_t change_count;
    bool committed;
    pthread_mutex_t staging; /* held to make NEW_NAME, and to see that it is not made any more */
    bool abandoned;
};

static lmb_result path_make(const lmb_bake_folder *folder, const char *below, const char *name, char path[MAX_PATH],
                            lmb_error *error)
{
    const int length = snprintf(path, MAX_PATH, "%s/%s%s%s", folder->directory, below, below[0] ? "/" : "", name);
    if (length < 0 || length >= MAX_PATH) {
        return lmb_error_set(error, LMB_ERROR_WRITE, "%.100s...: path is too long", folder->directory);
    }
    return LMB_OK;
}

static lmb_result write_fail(const char *path, int reason, lmb_error *error)
{
    return lmb_error_set(error, LMB_ERROR_WRITE, "%s: cannot be written: %s", path, strerror(reason));
}

/* Removes a folder of ours with all that is in it; follows no links. */
static void tree_remove(const char *path, int depth)
{
    DIR *const opened = depth < MAX_DEPTH ? opendir(path) : NULL;
    for (struct dirent *entry; opened && (entry = readdir(opened));) {
        char inner[MAX_PATH];
        struct stat status;
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0 ||
            snprintf(inner, sizeof inner, "%s/%s", path, entry->d_name) >= (int)sizeof inner ||
            lstat(inner, &status) != 0) {
            continue;
        }
        if (S_ISDIR(status.st_mode)) {
            tree_remove(inner, depth + 1);
        } else {
            unlink(inner);
        }
    }
    if (opened) {
        closedir(opened);
    }
    rmdir(path);
}

static void ours_remove(const lmb_bake_folder *folder, const char *name)
{
    char path[MAX_PATH];
    struct stat status;
    if (path_make(folder, "", name, path, NULL) == LMB_OK && lstat(path, &status) == 0 && S_ISDIR(status.st_mode)) {
        tree_remove(path, 0);
    }
}

/* mkdir -p; keeps in mind what it made. */
static lmb_result directory_make(lmb_bake_folder *folder, lmb_error *error)
{
    char path[MAX_PATH];
    const size_t length = strlen(folder->directory);
    memcpy(path, folder->directory, length + 1);
    for (size_t i = 1; i <= length; ++i) {
        if (path[i] != '/' && path[i] != '\0') {
            continue;
        }
        const char end = path[i];
        path[i] = '\0';
        if (mkdir(path, 0777) == 0) {
            folder->made_from = folder->made_from > 0 ? folder->made_from : i;
        } else if (errno != EEXIST) {
            return write_fail(path, errno, error);
        }
        path[i] = end;
    }
    struct stat status;
    if (stat(path, &status) != 0 || !S_ISDIR(status.st_mode)) {
        return lmb_error_set(error, LMB_ERROR_WRITE, "%s: not a folder", path);
    }
    return LMB_OK;
}

/* Takes back directory_make, as far as nobody has put anything there. */
static void directory_unmake(const lmb_bake_folder *folder)
{
    char path[MAX_PATH];
    size_t length = strlen(folder->directory);
    memcpy(path, folder->directory, length + 1);
    while (folder->made_from > 0 && length >= folder->made_from) {
        path[length] = '\0';
        if (rmdir(path) != 0 && errno != ENOENT) {
            return;
        }
        do {
            --length;
        } while (length >= folder->made_from && folder->directory[length] != '/');
    }
}

static lmb_result locked_elsewhere(const lmb_bake_folder *folder, int descriptor, lmb_error *error)
{
    char owner[32] = "";
    const ssize_t got = read(descriptor, owner, sizeof owner - 1);
    owner[got > 0 ? got : 0] = '\0';
    owner[strspn(owner, "0123456789")] = '\0';
    return lmb_error_set(error, LMB_ERROR_WRITE,
                         "%s: another bake is writing there%s%s; wait for it, or give another folder",
                         folder->directory, owner[0] ? ", process " : "", owner);
}

/* The lock's file goes with the bake that has it, so that after locking it must still be the one that is there. */
static lmb_result lock_take(lmb_bake_folder *folder, lmb_error *error)
{
    char path[MAX_PATH];
    lmb_result result = path_make(folder, "", LOCK_NAME, path, error);
    while (result == LMB_OK && folder->lock < 0) {
        const int descriptor = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
        if (descriptor < 0) {
            return write_fail(folder->directory, errno, error);
        }
        struct stat held, there;
        /* A file system without locks: nobody else is kept out. */
        if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
            result = locked_elsewhere(folder, descriptor, error);
        } else if (fstat(descriptor, &held) == 0 && stat(path, &there) == 0 && held.st_ino == there.st_ino &&
                   held.st_dev == there.st_dev) {
            folder->lock = descriptor;
            break;
        }
        close(descriptor);
    }
    char owner[32];
    const int length = snprintf(owner, sizeof owner, "%ld\n", (long)getpid());
    if (result == LMB_OK && (ftruncate(folder->lock, 0) != 0 || write(folder->lock, owner, (size_t)length) != length)) {
        return write_fail(folder->directory, errno, error);
    }
    return result;
}

static void lock_release(lmb_bake_folder *folder)
{
    char path[MAX_PATH];
    if (folder->lock >= 0 && path_make(folder, "", LOCK_NAME, path, NULL) == LMB_OK) {
        unlink(path);
    }
    if (folder->lock >= 0) {
        close(folder->lock);
        folder->lock = -1;
    }
}

/* What would stop a file from being replaced, or, when it is not `wanted`, from being removed. */
static lmb_result target_check(const lmb_bake_folder *folder, const char *name, bool wanted, lmb_error *error)
{
    char path[MAX_PATH];
    struct stat status;
    const lmb_result result = path_make(folder, "", name, path, error);
    if (result != LMB_OK || lstat(path, &status) != 0) {
        return result;
    }
    if (wanted && !S_ISREG(status.st_mode) && !S_ISLNK(status.st_mode)) {
        return lmb_error_set(error, LMB_ERROR_WRITE, "%s: not a file that a bake may replace; move it away", path);
    }
    if (access(path, W_OK) != 0 && errno == EPERM) { /* made immutable; permissions alone do not stop a rename */
        return lmb_error_set(error, LMB_ERROR_WRITE, "%s: may not be replaced: %s", path, strerror(EPERM));
    }
    return LMB_OK;
}

static lmb_result lightmap_folder_check(const lmb_bake_folder *folder, lmb_error *error)
{
    char path[MAX_PATH];
    struct stat status, own;
    const lmb_result result = path_make(folder, "", LIGHTMAP_NAME, path, error);
    if (result != LMB_OK || stat(path, &status) != 0) {
        return result;
    }
    if (!S_ISDIR(status.st_mode)) {
        return lmb_error_set(error, LMB_ERROR_WRITE, "%s: not a folder; move it away", path);
    }
    if (access(path, W_OK | X_OK) != 0) {
        return write_fail(path, errno, error);
    }
    if (stat(folder->directory, &own) != 0 || own.st_dev != status.st_dev) {
        return lmb_error_set(error, LMB_ERROR_WRITE, "%s: lies on another file system than %s", path,
                             folder->directory);
    }
    return LMB_OK;
}

static bool changes_have_lightmaps(const lmb_bake_folder *folder)
{
    bool any = false;
    for (size_t i = 0; i < folder->change_count; ++i) {
        any |= strncmp(folder->changes[i].name, LIGHTMAP_NAME "/", sizeof LIGHTMAP_NAME) == 0;
    }
    return any;
}

static lmb_result targets_check(const lmb_bake_folder *folder, lmb_error *error)
{
    static const char *const names[] = {
        RECORD_NAME,
        "probes.lmb",
        "probes.vdb",
        "probes.lmt",
        LMB_KEPT_PROBES,
        LMB_KEPT_LIGHTMAPS,
        LIGHTMAP_NAME "/lightmap.json",
        LIGHTMAP_NAME "/level_uv2.glb",
        LIGHTMAP_NAME "/lightmap_0.exr",
        LIGHTMAP_NAME "/lightmap_0.ktx2",
        LIGHTMAP_NAME "/lightmap_0.dds",
    };
    lmb_result result = LMB_OK;
    for (size_t i = 0; i < sizeof names / sizeof names[0] && result == LMB_OK; ++i) {
        if (folder->lightmaps || !strchr(names[i], '/')) {
            result = target_check(folder, names[i], true, error);
        }
    }
    for (size_t i = 0; i < folder->change_count && result == LMB_OK; ++i) {
        result = target_check(folder, folder->changes[i].name, false, error);
    }
    return result == LMB_OK && (folder->lightmaps || changes_have_lightmaps(folder))
               ? lightmap_folder_check(folder, error)
               : result;
}

/* probes_X_Y_Z.lmb */
static bool name_is_a_tile(const char *name)
{
    long long at[3];
    char own[64];
    if (sscanf(name, "probes_%10lld_%10lld_%10lld.lmb", &at[0], &at[1], &at[2]) != 3) {
        return false;
    }
    snprintf(own, sizeof own, "probes_%lld_%lld_%lld.lmb", at[0], at[1], at[2]);
    return strcmp(name, own) == 0;
}

/* A name that a bake makes: no other is ever touched, whatever a record says. */
static bool name_is_ours(const char *name)
{
    const size_t folder = sizeof LIGHTMAP_NAME "/" - 1;
    if (strncmp(name, LIGHTMAP_NAME "/", folder) == 0) {
        name += folder;
        return name[0] != '\0' && name[0] != '.' && !strchr(name, '/') && strlen(name) + folder < MAX_NAME;
    }
    return strcmp(name, "probes.lmb") == 0 || strcmp(name, "probes.vdb") == 0 || strcmp(name, "probes.lmt") == 0 ||
           strcmp(name, LMB_KEPT_PROBES) == 0 || strcmp(name, LMB_KEPT_LIGHTMAPS) == 0 || name_is_a_tile(name);
}

/* The change of that name, made where there is none yet. NULL: out of memory. */
static file_change *change_of(lmb_bake_folder *folder, const char *name)
{
    for (size_t i = 0; i < folder->change_count; ++i) {
        if (strcmp(folder->changes[i].name, name) == 0) {
            return &folder->changes[i];
        }
    }
    file_change *const larger = realloc(folder->changes, (folder->change_count + 1) * sizeof *larger);
    if (!larger) {
        return NULL;
    }
    folder->changes = larger;
    file_change *const added = &larger[folder->change_count++];
    *added = (file_change){.is_new = false};
    snprintf(added->name, sizeof added->name, "%s", name);
    return added;
}

/* The files of the bake whose record lies in `below`. One that cannot be read names none. */
static lmb_result earlier_files_list(lmb_bake_folder *folder, const char *below)
{
    char path[MAX_PATH];
    unsigned char *text = NULL;
    size_t size = 0;
    if (path_make(folder, below, RECORD_NAME, path, NULL) != LMB_OK ||
        lmb_file_read(path, &text, &size, NULL) != LMB_OK) {
        return LMB_OK;
    }
    cJSON *const record = cJSON_ParseWithLength((const char *)text, size);
    const cJSON *item;
    lmb_result result = LMB_OK;
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(record, "files"))
    {
        const char *const name = cJSON_GetStringValue(item);
        if (name && name_is_ours(name) && !change_of(folder, name)) {
            result = LMB_ERROR_MEMORY;
        }
    }
    cJSON_Delete(record);
    free(text);
    return result;
}

/* Finds what earlier bakes left, also those that were killed, and removes what these had not finished. */
static lmb_result leftovers_take(lmb_bake_folder *folder, lmb_error *error)
{
    static const char *const folders[] = {"", OLD_NAME, NEW_NAME};
    for (size_t i = 0; i < sizeof folders / sizeof folders[0]; ++i) {
        if (earlier_files_list(folder, folders[i]) != LMB_OK) {
            return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
        }
    }
    ours_remove(folder, OLD_NAME);
    ours_remove(folder, NEW_NAME);
    ours_remove(folder, GONE_NAME);
    return LMB_OK;
}

void lmb_bake_folder_abandon(lmb_bake_folder *folder)
{
    char path[MAX_PATH], gone[MAX_PATH];
    pthread_mutex_lock(&folder->staging);
    folder->abandoned = true;
    pthread_mutex_unlock(&folder->staging);
    if (path_make(folder, "", NEW_NAME, path, NULL) == LMB_OK &&
        path_make(folder, "", GONE_NAME, gone, NULL) == LMB_OK && rename(path, gone) == 0) {
        tree_remove(gone, 0); /* under another name: nobody writes more into it meanwhile */
    }
    lock_release(folder);
    directory_unmake(folder);
}

static void folder_free(lmb_bake_folder *folder)
{
    pthread_mutex_destroy(&folder->staging);
    free(folder->changes);
    free(folder);
}

lmb_result lmb_bake_folder_open(const char *directory, bool lightmaps, lmb_bake_folder **folder, lmb_error *error)
{
    lmb_bake_folder *const opened = calloc(1, sizeof *opened);
    if (!opened) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    opened->lock = -1;
    opened->lightmaps = lightmaps;
    pthread_mutex_init(&opened->staging, NULL);
    size_t length = strlen(directory);
    while (length > 1 && directory[length - 1] == '/') {
        --length;
    }
    if (length == 0 || length + MAX_NAME >= MAX_PATH) {
        folder_free(opened);
        return lmb_error_set(error, LMB_ERROR_WRITE, "'%.100s': %s", directory,
                             length == 0 ? "not a folder" : "path is too long");
    }
    memcpy(opened->directory, directory, length);
    lmb_result result = directory_make(opened, error);
    if (result == LMB_OK) {
        result = lock_take(opened, error);
    }
    if (result == LMB_OK) {
        result = leftovers_take(opened, error);
    }
    if (result == LMB_OK) {
        result = targets_check(opened, error);
    }
    if (result == LMB_OK) {
        *folder = opened;
    } else {
        lock_release(opened);
        directory_unmake(opened);
        folder_free(opened);
    }
    return result;
}

static lmb_result folder_add(const lmb_bake_folder *folder, const char *below, const char *name, lmb_error *error)
{
    char path[MAX_PATH];
    const lmb_result result = path_make(folder, below, name, path, error);
    return result == LMB_OK && mkdir(path, 0777) != 0 && errno != EEXIST ? write_fail(path, errno, error) : result;
}

const char *lmb_bake_folder_directory(const lmb_bake_folder *folder)
{
    return folder->directory;
}

bool lmb_bake_folder_lightmaps(const lmb_bake_folder *folder)
{
    return folder->lightmaps;
}

lmb_result lmb_bake_folder_stage(lmb_bake_folder *folder, const char **path, lmb_error *error)
{
    pthread_mutex_lock(&folder->staging);
    lmb_result result = folder->abandoned ? lmb_error_set(error, LMB_ERROR_INTERRUPTED, "interrupted")
                                          : folder_add(folder, "", NEW_NAME, error);
    pthread_mutex_unlock(&folder->staging);
    if (result == LMB_OK && folder->lightmaps) {
        result = folder_add(folder, NEW_NAME, LIGHTMAP_NAME, error);
    }
    if (result == LMB_OK) {
        result = path_make(folder, "", NEW_NAME, folder->stage, error);
    }
    if (result == LMB_OK) {
        *path = folder->stage;
    }
    return result;
}

static int is_visible(const struct dirent *entry)
{
    return entry->d_name[0] != '.';
}

/* Files of ours in the stage or a folder in it, by name. */
static bool staged_list(const lmb_bake_folder *folder, const char *below, cJSON *list)
{
    char path[MAX_PATH], name[MAX_NAME];
    struct dirent **entries = NULL;
    const bool fits = snprintf(path, sizeof path, "%s/%s", folder->stage, below) < (int)sizeof path;
    const int count = fits ? scandir(path, &entries, is_visible, alphasort) : -1;
    bool good = count >= 0;
    for (int i = 0; i < count; ++i) {
        snprintf(name, sizeof name, "%s%s%s", below, below[0] ? "/" : "", entries[i]->d_name);
        if (name_is_ours(name)) {
            good = cJSON_AddItemToArray(list, cJSON_CreateString(name)) && good;
        }
        free(entries[i]);
    }
    free(entries);
    return good;
}

cJSON *lmb_bake_folder_files(const lmb_bake_folder *folder)
{
    cJSON *const list = cJSON_CreateArray();
    if (!list || !staged_list(folder, "", list) || (folder->lightmaps && !staged_list(folder, LIGHTMAP_NAME, list))) {
        cJSON_Delete(list);
        return NULL;
    }
    return list;
}

void lmb_bake_folder_drop_parts(const lmb_bake_folder *folder)
{
    ours_remove(folder, LMB_PARTS_NAME);
}

static lmb_result file_move(const lmb_bake_folder *folder, const char *name, const char *from, const char *to,
                            lmb_error *error)
{
    char source[MAX_PATH], target[MAX_PATH];
    lmb_result result = path_make(folder, from, name, source, error);
    if (result == LMB_OK) {
        result = path_make(folder, to, name, target, error);
    }
    return result == LMB_OK && rename(source, target) != 0 ? write_fail(target, errno, error) : result;
}

/* Keeps the old version of a file. It stays in its place too, where the file system can do that and it is to be
 * replaced. */
static lmb_result file_keep(const lmb_bake_folder *folder, const char *name, bool stays, bool *kept, lmb_error *error)
{
    char path[MAX_PATH], old[MAX_PATH];
    struct stat status;
    lmb_result result = path_make(folder, "", name, path, error);
    if (result == LMB_OK) {
        result = path_make(folder, OLD_NAME, name, old, error);
    }
    if (result != LMB_OK || lstat(path, &status) != 0) {
        return result;
    }
    if (S_ISDIR(status.st_mode)) { /* no bake makes one */
        return stays ? write_fail(path, EISDIR, error) : LMB_OK;
    }
    *kept = (stays && link(path, old) == 0) || rename(path, old) == 0;
    return *kept ? LMB_OK : write_fail(path, errno, error);
}

/* fsync: names count as written too. A file system that cannot do it has lost nothing. */
static void folder_flush(const lmb_bake_folder *folder, const char *name)
{
    char path[MAX_PATH];
    const int descriptor =
        path_make(folder, "", name, path, NULL) == LMB_OK ? open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;
    if (descriptor >= 0) {
        fsync(descriptor);
        close(descriptor);
    }
}

static lmb_result changes_complete(lmb_bake_folder *folder, lmb_error *error)
{
    cJSON *const files = lmb_bake_folder_files(folder);
    bool good = files != NULL;
    const cJSON *item;
    cJSON_ArrayForEach(item, files)
    {
        file_change *const change = change_of(folder, item->valuestring);
        good = good && change;
        if (change) {
            change->is_new = true;
        }
    }
    cJSON_Delete(files);
    return good ? LMB_OK : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
}

/* Everything but the records. */
static lmb_result changes_make(lmb_bake_folder *folder, lmb_error *error)
{
    lmb_result result = LMB_OK;
    for (size_t i = 0; i < folder->change_count && result == LMB_OK; ++i) {
        file_change *const change = &folder->changes[i];
        result = file_keep(folder, change->name, change->is_new, &change->kept, error);
        if (result == LMB_OK && change->is_new) {
            result = file_move(folder, change->name, NEW_NAME, "", error);
            change->placed = result == LMB_OK;
        }
    }
    if (result == LMB_OK) {
        folder_flush(folder, LIGHTMAP_NAME);
        folder_flush(folder, "");
    }
    return result;
}

static void changes_undo(lmb_bake_folder *folder, bool record_kept)
{
    for (size_t i = 0; i < folder->change_count; ++i) {
        const file_change *const change = &folder->changes[i];
        char path[MAX_PATH];
        if (change->kept) {
            file_move(folder, change->name, OLD_NAME, "", NULL);
        } else if (change->placed && path_make(folder, "", change->name, path, NULL) == LMB_OK) {
            unlink(path);
        }
    }
    if (record_kept) {
        file_move(folder, RECORD_NAME, OLD_NAME, "", NULL);
    }
}

/* lightmap/ goes when the earlier bake's files were all that it had. */
static void lightmap_folder_trim(const lmb_bake_folder *folder)
{
    char path[MAX_PATH];
    if (changes_have_lightmaps(folder) && path_make(folder, "", LIGHTMAP_NAME, path, NULL) == LMB_OK) {
        rmdir(path); /* fails unless it is empty */
    }
}

lmb_result lmb_bake_folder_commit(lmb_bake_folder *folder, lmb_error *error)
{
    bool record_kept = false;
    lmb_result result = changes_complete(folder, error);
    if (result == LMB_OK) {
        result = folder_add(folder, "", OLD_NAME, error);
    }
    if (result == LMB_OK) {
        result = folder_add(folder, OLD_NAME, LIGHTMAP_NAME, error);
    }
    if (result == LMB_OK && folder->lightmaps) {
        result = folder_add(folder, "", LIGHTMAP_NAME, error);
    }
    if (result == LMB_OK) {
        result = file_keep(folder, RECORD_NAME, false, &record_kept, error);
    }
    if (result == LMB_OK) {
        result = changes_make(folder, error);
    }
    if (result == LMB_OK) {
        result = file_move(folder, RECORD_NAME, NEW_NAME, "", error);
    }
    if (result == LMB_OK) {
        folder_flush(folder, "");
        folder->committed = true;
    } else {
        changes_undo(folder, record_kept);
    }
    ours_remove(folder, OLD_NAME);
    lightmap_folder_trim(folder);
    return result;
}

void lmb_bake_folder_explain(const lmb_bake_folder *folder, lmb_error *error)
{
    char line[LMB_ERROR_MESSAGE_SIZE];
    if (!error) {
        return;
    }
    snprintf(line, sizeof line, "%s", error->message);
    char *const stage = strstr(line, "/" NEW_NAME "/");
    if (stage) {
        const char *const rest = stage + sizeof NEW_NAME;
        memmove(stage, rest, strlen(rest) + 1);
    }
    lmb_error_set(error, LMB_OK, "%.300s; %s", line,
                  folder->made_from > 0 ? "nothing was written" : "the folder is as it was");
}

void lmb_bake_folder_close(lmb_bake_folder *folder)
{
    if (!folder) {
        return;
    }
    ours_remove(folder, NEW_NAME);
    lock_release(folder);
    if (!folder->committed) {
        directory_unmake(folder);
    }
    folder_free(folder);
}
