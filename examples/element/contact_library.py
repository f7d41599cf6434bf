"""The contact element of railspring in Python: a thin layer over its C library.

`Contact` is statics with friction, for programs that integrate the wheel's modes themselves. `Unit` has these modes
inside, for programs that have hub and rail only. Both keep the end of the last step until `commit`. So a solver may try
as many motions as it likes.

Motions and forces are arrays: of each body y, z (m, N) and the rotation about x (rad, N m). Axes: x along the track, y
to the field side of the right rail, z down. P and Q are minus the forces z and y on the rim.

The library is that of the environment variable RAILSPRING_LIBRARY, or librailspring_c.so beside the element file.
Needs numpy.
"""
import ctypes
import os
import pathlib
import sys
import numpy as np

NAMES = {'win32': 'railspring_c.dll', 'darwin': 'librailspring_c.dylib'}
LIBRARY = None  # until an element is opened
OTHER_RAIL = -1.0  # the place of a wheel on a rail that is not the study's


def load(element_path):
    """Loads the library, once in a process."""
    global LIBRARY
    if LIBRARY is None:
        beside = pathlib.Path(element_path).resolve().with_name(NAMES.get(sys.platform, 'librailspring_c.so'))
        LIBRARY = ctypes.CDLL(os.environ.get('RAILSPRING_LIBRARY') or str(beside))
        LIBRARY.railspring_version.restype = LIBRARY.railspring_message.restype = ctypes.c_char_p


class ContactError(RuntimeError):
    """What the library says. Its `code` is 2 for a wrong input, 3 for no balance: then a shorter step may help."""

    def __init__(self, code):
        super().__init__(LIBRARY.railspring_message().decode())
        self.code = code


class About(ctypes.Structure):
    """RailspringAbout: what an element is like."""
    _fields_ = [('wheel_modes', ctypes.c_size_t), ('rail_modes', ctypes.c_size_t), ('friction', ctypes.c_double),
                ('largest_force', ctypes.c_double), ('rail_length', ctypes.c_double), ('place', ctypes.c_double),
                ('damping', ctypes.c_double * 2), ('hub', ctypes.c_double * 2), ('rail', ctypes.c_double * 3),
                ('origin', ctypes.c_double * 2)]


class Place(ctypes.Structure):
    """RailspringPlace: where rim and rail meet."""
    _fields_ = [('rail', ctypes.c_double * 2), ('wheel', ctypes.c_double * 2), ('normal_force', ctypes.c_double),
                ('tangential_force', ctypes.c_double), ('width', ctypes.c_double), ('slides', ctypes.c_int32)]


def call(name, *arguments):
    """Calls a function of the library; an error becomes an exception."""
    code = getattr(LIBRARY, 'railspring_' + name)(*arguments)
    if code:
        raise ContactError(code)


def address(array):
    """Where the numbers of an array begin. The array must be contiguous, of float64, and outlive the call."""
    return array.ctypes.data_as(ctypes.c_void_p)


class Handle:
    """An object of the library, freed with its Python object."""
    kind = ''

    def __init__(self, function, *arguments):
        self.pointer = ctypes.c_void_p()
        call(function, *arguments, ctypes.byref(self.pointer))

    def __del__(self):
        if getattr(self, 'pointer', None) and LIBRARY:
            free = getattr(LIBRARY, 'railspring_%s_free' % self.kind)
            free.restype = None
            free(self.pointer)


class Element(Handle):
    """What a file of an element has: the pair, the wheel's modes, and the rail's where it has some."""
    kind = 'element'

    def __init__(self, path):
        load(path)
        super().__init__('element_open', os.fsencode(path))
        self.about = About()
        call('element_about', self.pointer, ctypes.byref(self.about))
        size = 3 + self.about.wheel_modes
        # the whole wheel by hub (y, z, turn) and modes, and the rim's motion (y, z, turn) under these coordinates
        self.mass, self.damping, self.stiffness = np.zeros((3, size, size))
        self.rim = np.zeros((3, size))
        matrices = self.mass, self.damping, self.stiffness, self.rim
        call('element_superelement', self.pointer, *map(address, matrices))
        # the hub alone, for a Unit
        self.hub_mass = np.zeros((3, 3))
        call('element_hub_mass', self.pointer, address(self.hub_mass))
        # the rail: modes of 1 kg, motions of the section by mode (rows), and flexibility beyond them
        self.rail_squares = np.zeros(self.about.rail_modes)
        self.rail_sections, self.rail_rest = np.zeros((self.about.rail_modes, 3)), np.zeros((3, 3))
        if self.about.rail_modes:
            call('element_rail', self.pointer, *map(address, (self.rail_squares, self.rail_sections, self.rail_rest)))


class Stepped(Handle):
    """What Contact and Unit have in common."""

    def set_section_rest(self, flexibility):
        """Gives the rail's section a flexibility (3 by 3) beyond the motions that the program gives it."""
        call(self.kind + '_set_section_rest', self.pointer, address(np.ascontiguousarray(flexibility, float)))

    def commit(self):
        """Ends a step where it was evaluated last."""
        call(self.kind + '_commit', self.pointer)

    def places(self):
        """The contacts as evaluated last."""
        places, count = (Place * 8)(), ctypes.c_size_t()
        call(self.kind + '_places', self.pointer, places, ctypes.c_size_t(len(places)), ctypes.byref(count))
        return places[:count.value]


class Contact(Stepped):
    """The contact as statics. Motions are of rim and section (6), forces on both (6), with a tangent (6 by 6)."""
    kind = 'contact'

    def __init__(self, element, friction=float('nan')):
        super().__init__('contact_new', element.pointer, ctypes.c_double(friction))
        self._motions, self._forces = np.zeros(7), np.zeros(42)
        self._arguments = self.pointer, address(self._motions), address(self._forces)

    def _at(self, function, motions, place):
        self._motions[:6], self._motions[6] = motions, place
        call(function, *self._arguments)
        found = self._forces.copy()
        return found[:6], found[6:].reshape(6, 6)

    def start(self, motions, place):
        """Begins there, with friction that has taken up nothing. Forces and tangent."""
        return self._at('contact_start', motions, place)

    def evaluate(self, motions, place):
        """Forces and tangent at the end of a step to these motions."""
        return self._at('contact_evaluate', motions, place)


class Unit(Stepped):
    """The contact with the wheel's modes. Motions are of hub and section (6), forces on hub, section and rim (9)."""
    kind = 'unit'

    def __init__(self, element, friction=float('nan'), gravity=0.0):
        super().__init__('unit_new', element.pointer, ctypes.c_double(friction), ctypes.c_double(gravity))
        self._host, self._forces, self._tangent = np.zeros(13), np.zeros(9), np.zeros((6, 6))

    def _set(self, motions, velocities, place):
        self._host[0:3], self._host[6:9] = motions[:3], motions[3:]
        self._host[3:6], self._host[9:12] = velocities[:3], velocities[3:]
        self._host[12] = place
        return address(self._host)

    def start(self, motions, velocities, place, bent=False):
        """Begins there, with modes that do not swing. The forces."""
        call('unit_start', self.pointer, self._set(motions, velocities, place), ctypes.c_int32(bent),
             address(self._forces))
        return self._forces.copy()

    def advance(self, length, motions, velocities, place):
        """The forces at the end of a step of a length (s) to these motions."""
        call('unit_advance', self.pointer, ctypes.c_double(length), self._set(motions, velocities, place),
             address(self._forces))
        return self._forces.copy()

    def tangent(self):
        """Derivatives of the last forces on hub and section by their displacements (6 by 6)."""
        call('unit_tangent', self.pointer, address(self._tangent))
        return self._tangent.copy()
