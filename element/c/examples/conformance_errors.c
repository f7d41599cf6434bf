/* Input that cannot be used has to return RAILSPRING_CODE_INPUT with a message, and leave everything as it was. */
#include "conformance.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The text of the call is the name of the check. */
#define REFUSED(call) refused((call), #call)
#define DONE(call) expect((call) == RAILSPRING_CODE_DONE, #call)

static void refused(RailspringCode code, const char *what)
{
    char text[300];
    int holds = code == RAILSPRING_CODE_INPUT && railspring_message()[0] != '\0';
    snprintf(text, sizeof text, "%s: code %d, \"%.100s\"", what, (int)code, railspring_message());
    expect(holds, text);
}

static void null_pointers(const char *path, const RailspringElement *element, const RailspringAbout *about)
{
    RailspringElement *other = NULL;
    RailspringContact *contact = NULL, *copy = NULL;
    RailspringUnit *unit = NULL, *second = NULL;
    RailspringMotions motions = {{0}, {0}, place_at(about, 0.5)};
    RailspringHost host = {{0}, {0}, {0}, {0}, place_at(about, 0.5)};
    RailspringForces forces;
    RailspringHostForces host_forces;
    RailspringPlace places[4];
    double flexibility[9] = {0}, values[36];
    size_t count;
    need(railspring_contact_new(element, NAN, &contact), "contact");
    need(railspring_unit_new(element, NAN, 0.0, &unit), "unit");

    REFUSED(railspring_element_open(NULL, &other));
    REFUSED(railspring_element_open(path, NULL));
    REFUSED(railspring_element_read(NULL, 10, &other));
    REFUSED(railspring_element_read((const uint8_t *)path, strlen(path), NULL));
    REFUSED(railspring_element_about(NULL, NULL));
    REFUSED(railspring_element_about(element, NULL));
    REFUSED(railspring_element_superelement(NULL, values, NULL, NULL, NULL));
    DONE(railspring_element_superelement(element, NULL, NULL, NULL, NULL));
    REFUSED(railspring_element_hub_mass(NULL, values));
    REFUSED(railspring_element_hub_mass(element, NULL));
    REFUSED(railspring_element_rail(NULL, NULL, NULL, values));
    DONE(railspring_element_rail(element, NULL, NULL, NULL));
    REFUSED(railspring_element_wheel_modes(NULL, values, NULL, NULL));
    DONE(railspring_element_wheel_modes(element, NULL, NULL, NULL));

    REFUSED(railspring_contact_new(NULL, NAN, &copy));
    REFUSED(railspring_contact_new(element, NAN, NULL));
    REFUSED(railspring_contact_new(element, -0.1, &copy));
    REFUSED(railspring_contact_new(element, INFINITY, &copy));
    REFUSED(railspring_contact_clone(NULL, &copy));
    REFUSED(railspring_contact_clone(contact, NULL));
    REFUSED(railspring_contact_restore(NULL, contact));
    REFUSED(railspring_contact_restore(contact, NULL));
    REFUSED(railspring_contact_set_section_rest(NULL, flexibility));
    REFUSED(railspring_contact_set_section_rest(contact, NULL));
    REFUSED(railspring_contact_start(NULL, &motions, &forces));
    REFUSED(railspring_contact_start(contact, NULL, &forces));
    REFUSED(railspring_contact_start(contact, &motions, NULL));
    REFUSED(railspring_contact_evaluate(NULL, &motions, &forces));
    REFUSED(railspring_contact_evaluate(contact, NULL, &forces));
    REFUSED(railspring_contact_evaluate(contact, &motions, NULL));
    REFUSED(railspring_contact_commit(NULL));
    REFUSED(railspring_contact_places(NULL, places, 4, &count));
    REFUSED(railspring_contact_places(contact, places, 4, NULL));
    DONE(railspring_contact_places(contact, NULL, 0, &count));

    REFUSED(railspring_unit_new(NULL, NAN, 0.0, &second));
    REFUSED(railspring_unit_new(element, NAN, 0.0, NULL));
    REFUSED(railspring_unit_new(element, -0.1, 0.0, &second));
    REFUSED(railspring_unit_new(element, NAN, NAN, &second));
    REFUSED(railspring_unit_clone(NULL, &second));
    REFUSED(railspring_unit_clone(unit, NULL));
    REFUSED(railspring_unit_restore(NULL, unit));
    REFUSED(railspring_unit_restore(unit, NULL));
    REFUSED(railspring_unit_set_section_rest(NULL, flexibility));
    REFUSED(railspring_unit_set_section_rest(unit, NULL));
    REFUSED(railspring_unit_start(NULL, &host, 0, &host_forces));
    REFUSED(railspring_unit_start(unit, NULL, 0, &host_forces));
    REFUSED(railspring_unit_start(unit, &host, 0, NULL));
    REFUSED(railspring_unit_advance(NULL, 1e-5, &host, &host_forces));
    REFUSED(railspring_unit_advance(unit, 1e-5, NULL, &host_forces));
    REFUSED(railspring_unit_advance(unit, 1e-5, &host, NULL));
    REFUSED(railspring_unit_advance(unit, NAN, &host, &host_forces));
    REFUSED(railspring_unit_advance(unit, -1e-5, &host, &host_forces));
    REFUSED(railspring_unit_tangent(NULL, values));
    REFUSED(railspring_unit_commit(NULL));
    REFUSED(railspring_unit_places(NULL, places, 4, &count));
    REFUSED(railspring_unit_places(unit, places, 4, NULL));
    expect(!other && !copy && !second, "a call that fails leaves the pointer it should set as it was");
    for (int i = 0; i < 100; i++) { /* a leak checker sees what these leave behind */
        REFUSED(railspring_element_open(path, NULL));
        REFUSED(railspring_contact_new(element, NAN, NULL));
        REFUSED(railspring_unit_clone(unit, NULL));
    }
    railspring_element_free(NULL);
    railspring_contact_free(NULL);
    railspring_unit_free(NULL);
    railspring_contact_free(contact);
    railspring_unit_free(unit);
}

/* A state can be taken over from an object of the same element alone. */
static void other_elements(const char *path, const RailspringElement *element)
{
    RailspringElement *other = NULL;
    RailspringContact *contact = NULL, *foreign = NULL;
    RailspringUnit *unit = NULL, *second = NULL;
    need(railspring_element_open(path, &other), path);
    need(railspring_contact_new(element, NAN, &contact), "contact");
    need(railspring_contact_new(other, NAN, &foreign), "contact");
    need(railspring_unit_new(element, NAN, 0.0, &unit), "unit");
    need(railspring_unit_new(other, NAN, 0.0, &second), "unit");
    railspring_element_free(other); /* contacts and units keep what they need */
    REFUSED(railspring_contact_restore(contact, foreign));
    REFUSED(railspring_unit_restore(unit, second));
    railspring_contact_free(contact);
    railspring_contact_free(foreign);
    railspring_unit_free(unit);
    railspring_unit_free(second);
}

/* A flexibility has to be finite, symmetric and without negative energy. */
static void flexibilities(const RailspringElement *element)
{
    static const double bad[][9] = {
        {NAN, 0, 0, 0, 1e-10, 0, 0, 0, 1e-8},       {INFINITY, 0, 0, 0, 1e-10, 0, 0, 0, 1e-8},   {1e-10, 1e-10, 0, 0, 1e-10, 0, 0, 0, 1e-8},
        {-1e-10, 0, 0, 0, 1e-10, 0, 0, 0, 1e-8},    {1e-10, 0, 1e-8, 0, 1e-10, 0, 1e-8, 0, 1e-8},
    };
    static const double none[9] = {0};
    RailspringContact *contact = NULL;
    RailspringUnit *unit = NULL;
    need(railspring_contact_new(element, NAN, &contact), "contact");
    need(railspring_unit_new(element, NAN, 0.0, &unit), "unit");
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        REFUSED(railspring_contact_set_section_rest(contact, bad[i]));
        REFUSED(railspring_unit_set_section_rest(unit, bad[i]));
    }
    DONE(railspring_contact_set_section_rest(contact, none));
    DONE(railspring_unit_set_section_rest(unit, none));
    railspring_contact_free(contact);
    railspring_unit_free(unit);
}

void check_errors(const char *path, const RailspringElement *element, const RailspringAbout *about)
{
    null_pointers(path, element, about);
    other_elements(path, element);
    flexibilities(element);
}

void check_files(const char *path)
{
    RailspringElement *element = NULL;
    FILE *file = fopen(path, "rb");
    size_t length = 0, capacity = (size_t)1 << 24;
    uint8_t *bytes = malloc(capacity);
    if (!file || !bytes || !(length = fread(bytes, 1, capacity, file))) {
        fprintf(stderr, "%s: cannot be read\n", path);
        exit(2);
    }
    fclose(file);
    REFUSED(railspring_element_open("no such file.rse", &element));
    REFUSED(railspring_element_open(".", &element));
    REFUSED(railspring_element_open("", &element));
    REFUSED(railspring_element_open("\xff\xfe", &element));
    REFUSED(railspring_element_read(bytes, 0, &element));
    for (size_t part = 1; part < length; part = part * 3 / 2 + 1) refused(railspring_element_read(bytes, part, &element), "a part of a file");
    refused(railspring_element_read(bytes, length - 1, &element), "a file without its last byte");
    need(railspring_element_read(bytes, length, &element), "the whole file");
    railspring_element_free(element);
    uint64_t state = 7;
    for (int turn = 0; turn < 300; turn++) { /* a changed byte may pass, but must not be a defect */
        size_t at = (size_t)(random_unit(&state) * (double)(turn % 2 ? length : 4096)) % length;
        uint8_t kept = bytes[at];
        bytes[at] ^= (uint8_t)(1 + random_unit(&state) * 254.0);
        element = NULL;
        RailspringCode code = railspring_element_read(bytes, length, &element);
        expect(code == RAILSPRING_CODE_DONE || code == RAILSPRING_CODE_INPUT, "a file with a changed byte");
        railspring_element_free(element);
        bytes[at] = kept;
    }
    element = NULL;
    for (size_t i = 0; i < length; i++) bytes[i] = (uint8_t)(random_unit(&state) * 256.0);
    refused(railspring_element_read(bytes, length, &element), "random bytes");
    expect(!element, "a file that is refused leaves the pointer as it was");
    free(bytes);
}
