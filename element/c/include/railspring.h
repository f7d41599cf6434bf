/* The contact element of a railway wheel and a rail, by railspring. SI units: N, m, kg, s, rad. Axes: x along the track, y to the field side of the right rail, z down. */

#ifndef RAILSPRING_H
#define RAILSPRING_H

#include <stddef.h>
#include <stdint.h>

// The place of a wheel on a rail that is not the study's: its head is as far from any held end.
#define RAILSPRING_OTHER_RAIL -1.0

// What a function returns.
typedef enum {
  // Done.
  RAILSPRING_CODE_DONE = 0,
  // The input cannot be used: a pointer that is null, a motion that is no number or out of range, a file of another layout, a wheel that has left the profiles.
  RAILSPRING_CODE_INPUT = 2,
  // The input can be used, but no balance of forces was found: try a shorter step.
  RAILSPRING_CODE_NUMERICS = 3,
  // A defect of the library: free the object, and report the message.
  RAILSPRING_CODE_DEFECT = 4,
} RailspringCode;

// A contact with its state, for one thread at a time.
typedef struct RailspringContact RailspringContact;

// An element: what is read from a file. It does not change, and any number of threads may use it.
typedef struct RailspringElement RailspringElement;

// A unit with its state, for one thread at a time.
typedef struct RailspringUnit RailspringUnit;

// What an element is like.
typedef struct {
  // Modes of the wheel.
  size_t wheel_modes;
  // Modes of the rail in the file; 0 where it has none.
  size_t rail_modes;
  // Coefficient of friction of the study.
  double friction;
  // Largest normal force of the loads that the element was fitted to, N.
  double largest_force;
  // Length of a rail with held ends, m; NaN where the head is the same everywhere.
  double rail_length;
  // Place of the wheel for which the rail's modes are, m; NaN where there are none.
  double place;
  // Damping over stiffness of the wheel's and of the rail's modes, s.
  double damping[2];
  // From the origin of the wheel's profile to the hub's centre (y, z), m.
  double hub[2];
  // Place of the rail's profile in the track: its turn from y towards z (rad), and where its origin is (y, z from the middle of the track and the top of the rail, m).
  double rail[3];
  // From the rail's line of shear centres to the origin of the wheel's profile where it just touches (y, z), m.
  double origin[2];
} RailspringAbout;

// Motions of rim and rail section at the end of a step, from where the wheel just touches: displacements y, z (m) and the rotation about x (rad).
typedef struct {
  // The rim as hub and modes have it, about the origin of the wheel's profile.
  double rim[3];
  // The section of the rail, about its line of shear centres.
  double section[3];
  // Place of the wheel along the study's rail, m from its first end; RAILSPRING_OTHER_RAIL on a rail of the host's own.
  double place;
} RailspringMotions;

// Forces y, z (N) and torques about x (N·m) at the points of the motions.
typedef struct {
  // On the rim: minus Q and P are the first two.
  double rim[3];
  // On the section of the rail. Near a held end of the study's rail less than on its head, which the end holds as well.
  double section[3];
  // Derivatives of rim and section forces by rim and section motions, six rows; N/m, N, N·m. Minus a stiffness, to the first order: after a step of 2 µm 2 % off in half of the states, of the largest of a block, 7 % in one of a hundred.
  double tangent[36];
} RailspringForces;

// A contact.
typedef struct {
  // Where its normal force acts on the rail (y, z), profile frame, m.
  double rail[2];
  // The same on the wheel.
  double wheel[2];
  // Force along the normal, N.
  double normal_force;
  // Friction force on the wheel a quarter of a turn from the normal one, N.
  double tangential_force;
  // Width along the profile, m.
  double width;
  // 1 where it slides, 0 where it sticks.
  int32_t slides;
} RailspringPlace;

// A host's motions: displacements y, z (m) and the rotation about x (rad) from where the wheel just touches, velocities in m/s and rad/s.
typedef struct {
  // The wheel's hub at its centre.
  double hub[3];
  // Its velocity.
  double hub_velocity[3];
  // The section of the rail, about its line of shear centres.
  double section[3];
  // Its velocity.
  double section_velocity[3];
  // Place of the wheel along the study's rail, m from its first end; RAILSPRING_OTHER_RAIL on a rail of the host's own.
  double place;
} RailspringHost;

// Forces y, z (N) and torques about x (N·m) at the points of a host's motions.
typedef struct {
  // Of the wheel on its hub.
  double hub[3];
  // Of the wheel on the section of the rail. Near a held end of the study's rail less than on its head, which the end holds as well.
  double section[3];
  // On the rim, about the origin of the wheel's profile: minus Q and P are the first two.
  double rim[3];
} RailspringHostForces;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The version of the library, for instance "0.1.0".
const char *railspring_version(void);

// What was wrong in the last call of this thread that did not return RAILSPRING_CODE_DONE, in UTF-8; empty where there was none. It stays until the next such call of the thread.
const char *railspring_message(void);

// Opens the element file at `path` (UTF-8, ends with 0) and puts the element to `element`. Free it with railspring_element_free; contacts and units keep what they need.
RailspringCode railspring_element_open(const char *path,
                                       RailspringElement **element);

// The same from `length` bytes of an element file at `bytes`.
RailspringCode railspring_element_read(const uint8_t *bytes,
                                       size_t length,
                                       RailspringElement **element);

// Frees an element; null does nothing.
void railspring_element_free(RailspringElement *element);

// What an element is like.
RailspringCode railspring_element_about(const RailspringElement *element, RailspringAbout *about);

// The wheel as a superelement of n = 3 + wheel_modes coordinates, for hosts that integrate its modes: hub y, z (m) and rotation about x (rad), then the modes' amplitudes.
// `mass`, `damping` and `stiffness` have n·n values by rows, `rim` 3·n: the rim's motion under the coordinates. Null where one is not wanted.
RailspringCode railspring_element_superelement(const RailspringElement *element,
                                               double *mass,
                                               double *damping,
                                               double *stiffness,
                                               double *rim);

// Mass of a host's hub whose wheel's modes are in a unit: nine values by rows, about its centre; kg, kg·m, kg·m².
RailspringCode railspring_element_hub_mass(const RailspringElement *element,
                                           double *mass);

// The rail of the study as a wheel in one place feels it, by rail_modes modes of mass 1 kg. Squares of their angular frequencies (1/s²); motions of the section (y, z, rotation about x; three values
// each). Then nine values by rows of the section's flexibility beyond them. Null where one is not wanted.
RailspringCode railspring_element_rail(const RailspringElement *element,
                                       double *squares,
                                       double *sections,
                                       double *rest);

// The wheel's modes with the hub held, of mass 1 kg each: squares of their angular frequencies (1/s²), motions of the rim and masses between the mode and the hub's motions (three values each). Null where one
// is not wanted.
RailspringCode railspring_element_wheel_modes(const RailspringElement *element,
                                              double *squares,
                                              double *rims,
                                              double *couplings);

// A contact of an element on which friction has taken up nothing, where all motions are zero. A `coefficient` of friction that is not a number is that of the study.
RailspringCode railspring_contact_new(const RailspringElement *element,
                                      double coefficient,
                                      RailspringContact **contact);

// Frees a contact; null does nothing.
void railspring_contact_free(RailspringContact *contact);

// A copy of a contact with its state.
RailspringCode railspring_contact_clone(const RailspringContact *contact,
                                        RailspringContact **clone);

// Takes over the state at the end of the last step of `other`, a contact of the same RailspringElement, with its friction and the flexibility of its section.
RailspringCode railspring_contact_restore(RailspringContact *contact,
                                          const RailspringContact *other);

// Gives the section of the host's rail a flexibility that its motions do not have, before railspring_contact_start: nine values by rows; m/N, rad/N, rad/(N·m).
RailspringCode railspring_contact_set_section_rest(RailspringContact *contact,
                                                   const double *rest);

// Begins, or begins again, with bodies at `motions` on which friction has taken up nothing; the forces there to `forces`.
RailspringCode railspring_contact_start(RailspringContact *contact,
                                        const RailspringMotions *motions,
                                        RailspringForces *forces);

// The forces at the end of a step to `motions`. They depend on these and on the end of the last step alone; the state stays until railspring_contact_commit.
RailspringCode railspring_contact_evaluate(RailspringContact *contact,
                                           const RailspringMotions *motions,
                                           RailspringForces *forces);

// Takes what was evaluated last as the end of a step. Where nothing was evaluated since the last one, or that failed, it changes nothing.
RailspringCode railspring_contact_commit(RailspringContact *contact);

// The contacts as evaluated last: how many to `count`, and the first `capacity` of them to `places`.
RailspringCode railspring_contact_places(const RailspringContact *contact,
                                         RailspringPlace *places,
                                         size_t capacity,
                                         size_t *count);

// A unit of an element on which friction has taken up nothing, where all motions are zero. A `coefficient` of friction that is not a number is that of the study;
// `gravity` acts on the wheel's modes, m/s², the weight of the hub is the host's.
RailspringCode railspring_unit_new(const RailspringElement *element,
                                   double coefficient,
                                   double gravity,
                                   RailspringUnit **unit);

// Frees a unit; null does nothing.
void railspring_unit_free(RailspringUnit *unit);

// A copy of a unit with its state.
RailspringCode railspring_unit_clone(const RailspringUnit *unit, RailspringUnit **clone);

// Takes over the state at the end of the last step of `other`, a unit of the same RailspringElement, with its friction and the flexibility of its section.
RailspringCode railspring_unit_restore(RailspringUnit *unit,
                                       const RailspringUnit *other);

// As railspring_contact_set_section_rest.
RailspringCode railspring_unit_set_section_rest(RailspringUnit *unit, const double *rest);

// Begins, or begins again, with the host at its motions, friction that has taken up nothing, and modes that do not swing: as the hub has them, or, with `bent` other than 0, bent by weight and contact. The forces
// there to `forces`.
RailspringCode railspring_unit_start(RailspringUnit *unit,
                                     const RailspringHost *host,
                                     int32_t bent,
                                     RailspringHostForces *forces);

// The forces at the end of a step of a `length` (s, at most 0.1) from the end of the last one to a host's motions. They depend on these and on the end of the last step alone; the state stays until
// railspring_unit_commit. Between both ends the motions are cubics with their velocities; the element divides the step as its forces ask for.
RailspringCode railspring_unit_advance(RailspringUnit *unit,
                                       double length,
                                       const RailspringHost *host,
                                       RailspringHostForces *forces);

// Derivatives of the forces that railspring_unit_advance found last by the displacements of hub and section at the end of its step: 36 values, six rows (hub before section); N/m, N, N·m. They are those of the last inner step: a good guess for steps of up to 100 µs. Without such a step they are zero.
RailspringCode railspring_unit_tangent(const RailspringUnit *unit,
                                       double *tangent);

// Takes what railspring_unit_advance found last as the end of a step. Where nothing was found since the last one, or that failed, it changes nothing.
RailspringCode railspring_unit_commit(RailspringUnit *unit);

// The contacts as found last: how many to `count`, and the first `capacity` of them to `places`.
RailspringCode railspring_unit_places(const RailspringUnit *unit,
                                      RailspringPlace *places,
                                      size_t capacity,
                                      size_t *count);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* RAILSPRING_H */
