"""The window: glfw for window and input, moderngl for pictures, imgui-bundle for panels."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import glfw
import moderngl
import numpy as np
from imgui_bundle import imgui
from numpy.typing import NDArray

from nofacet import InputError

from . import opengl  # noqa: F401  # sets up what the back end calls
from .controls import Button, Point
from .keymap import KEYS
from .panel_picture import PanelPicture

# isort: split
from imgui_bundle.python_backends.glfw_backend import GlfwRenderer  # noqa: E402

Paint = Callable[[moderngl.Framebuffer], None]  # draws into its lower left corner, as large as the window

OPENGL_VERSION = (3, 3)
BUTTONS = {
    glfw.MOUSE_BUTTON_LEFT: Button.LEFT,
    glfw.MOUSE_BUTTON_MIDDLE: Button.MIDDLE,
    glfw.MOUSE_BUTTON_RIGHT: Button.RIGHT,
}
_OTHER_NAMES = {
    "PageUp": "PAGE_UP",
    "PageDown": "PAGE_DOWN",
    "-": "MINUS",
    "=": "EQUAL",
    ",": "COMMA",
    ".": "PERIOD",
    "/": "SLASH",
    ";": "SEMICOLON",
    "'": "APOSTROPHE",
    "[": "LEFT_BRACKET",
    "]": "RIGHT_BRACKET",
    "\\": "BACKSLASH",
    "`": "GRAVE_ACCENT",
}
# glfw's number of a key -> its name in the keymap; the keypad's keys are the same keys.
KEY_NAMES = {getattr(glfw, f"KEY_{_OTHER_NAMES.get(name, name.upper())}"): name for name in KEYS}
KEY_NAMES |= {getattr(glfw, f"KEY_KP_{digit}"): str(digit) for digit in range(10)} | {glfw.KEY_KP_ENTER: "Enter"}
_MODIFIERS = {glfw.MOD_CONTROL: "Ctrl", glfw.MOD_SHIFT: "Shift", glfw.MOD_ALT: "Alt"}


class Input(Protocol):
    """Who is told what the user does, if it is not for a panel. Positions are in framebuffer pixels, y down."""

    def on_key(self, key: str, modifiers: frozenset[str]) -> None: ...
    def on_press(self, button: Button, at: Point, modifiers: frozenset[str]) -> None: ...
    def on_release(self, button: Button, at: Point) -> None: ...
    def on_move(self, at: Point) -> None: ...
    def on_wheel(self, notches: float, modifiers: frozenset[str]) -> None: ...
    def on_drop(self, paths: Sequence[str]) -> None: ...


class Window:
    """One window with its OpenGL context. One per process: imgui has one context."""

    def __init__(self, title: str, size: tuple[int, int]) -> None:
        """size: width and height in screen coordinates. Raises InputError where no window can be opened."""
        self._handle = _open(title, size)
        self.context: Any = moderngl.create_context()
        imgui.create_context()
        imgui.get_io().set_ini_filename("")  # no file left behind
        self._gui: Any = GlfwRenderer(self._handle, attach_callbacks=False)
        self._panels = PanelPicture(self.context, self._gui)
        self.resized = True  # since the caller has set it to False
        self._input: Input | None = None
        self._at: Point = (0.0, 0.0)  # the cursor as of the last event: asking glfw gives where it is by now
        self._moved_to: Point | None = None  # in screen coordinates, while the receiver does not know of it

    def attach(self, receiver: Input) -> None:
        """Tell `receiver` of all input from now on."""
        self._input = receiver
        self._at = self._position(*glfw.get_cursor_pos(self._handle))
        glfw.set_key_callback(self._handle, self._on_key)
        glfw.set_char_callback(self._handle, self._gui.char_callback)
        glfw.set_mouse_button_callback(self._handle, self._on_button)
        glfw.set_cursor_pos_callback(self._handle, self._on_cursor)
        glfw.set_scroll_callback(self._handle, self._on_scroll)
        on_drop: Any = self._on_drop  # glfw's stubs have the signature of the C function
        glfw.set_drop_callback(self._handle, on_drop)
        glfw.set_framebuffer_size_callback(self._handle, self._on_resize)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the picture in pixels; 0 while the window is minimized."""
        width, height = glfw.get_framebuffer_size(self._handle)
        return width, height

    @property
    def should_close(self) -> bool:
        return bool(glfw.window_should_close(self._handle))

    @property
    def over_panel(self) -> bool:
        """Whether the mouse is over a panel, so that its input is not for the picture."""
        return bool(imgui.get_io().want_capture_mouse)

    def set_title(self, title: str) -> None:
        glfw.set_window_title(self._handle, title)

    def wait(self, seconds: float) -> None:
        """Handle the input that there is; without any, wait for some, or for wake(), at most so long.

        Of the mouse's motions the receiver is told where they have led to: mice report more of them than pictures can
        show.
        """
        if seconds > 0:
            glfw.wait_events_timeout(seconds)
        else:
            glfw.poll_events()
        self._tell_motion()

    @staticmethod
    def wake() -> None:
        """End wait(); from any thread."""
        glfw.post_empty_event()

    def draw(self, paint: Paint, panels: Callable[[], None] | None = None) -> None:
        """Draw a picture, as large as the window, and panels before it; None: as they were, at a fraction of the cost.
        Still to be shown: present()."""
        if panels:
            self._gui.process_inputs()
            imgui.new_frame()
            panels()
            imgui.render()
            self._panels.update(self.size)
        self._draw_into(self.context.screen, paint)

    def pixels(self, paint: Paint) -> NDArray[np.uint8]:
        """What draw() has drawn of the picture and panels: (height, width, 3), sRGB, row 0 at the top."""
        width, height = self.size
        target = self.context.simple_framebuffer((width, height), 3)
        self._draw_into(target, paint)
        data = target.read(components=3, alignment=1)
        target.release()
        return np.frombuffer(data, np.uint8).reshape(height, width, 3)[::-1].copy()

    def present(self) -> None:
        glfw.swap_buffers(self._handle)

    def close(self) -> None:
        """Close the window and free all that belongs to it."""
        self._panels.release()
        self._gui.shutdown()
        imgui.destroy_context()
        self.context.release()
        glfw.destroy_window(self._handle)
        glfw.terminate()

    def _draw_into(self, target: moderngl.Framebuffer, paint: Paint) -> None:
        # The screen's own size is what it was when the window was opened.
        target.viewport = target.scissor = 0, 0, *self.size
        paint(target)
        self._panels.draw(target)

    def _position(self, x: float, y: float) -> Point:
        """Framebuffer pixels of screen coordinates."""
        wide, high = glfw.get_window_size(self._handle)
        width, height = self.size
        return x * width / max(wide, 1), y * height / max(high, 1)

    def _tell_motion(self) -> None:
        """Of the mouse, since the last time: before any other input, and after the last."""
        if self._moved_to is None:
            return
        (x, y), self._moved_to = self._moved_to, None
        imgui.get_io().add_mouse_pos_event(x, y)
        self._at = self._position(x, y)
        if self._input:
            self._input.on_move(self._at)

    def _on_key(self, window: Any, code: int, scancode: int, action: int, bits: int) -> None:
        self._tell_motion()
        self._gui.keyboard_callback(window, code, scancode, action, bits)
        name = KEY_NAMES.get(code)
        if self._input and name and action != glfw.RELEASE and not imgui.get_io().want_text_input:
            self._input.on_key(name, _modifiers(bits))

    def _on_button(self, _: Any, code: int, action: int, bits: int) -> None:
        self._tell_motion()
        imgui.get_io().add_mouse_button_event(code, action == glfw.PRESS)
        button = BUTTONS.get(code)
        if self._input is None or button is None:
            return
        if action == glfw.RELEASE:
            self._input.on_release(button, self._at)
        elif not imgui.get_io().want_capture_mouse:
            self._input.on_press(button, self._at, _modifiers(bits))

    def _on_cursor(self, _: Any, x: float, y: float) -> None:
        self._moved_to = x, y

    def _on_scroll(self, window: Any, x: float, y: float) -> None:
        self._tell_motion()
        imgui.get_io().add_mouse_wheel_event(x, y)
        if self._input and not imgui.get_io().want_capture_mouse:
            self._input.on_wheel(y, _held_modifiers(window))

    def _on_drop(self, _: Any, paths: Any) -> None:
        if self._input:
            self._input.on_drop(paths)

    def _on_resize(self, *_: Any) -> None:
        self.resized = True


def _open(title: str, size: tuple[int, int]) -> Any:
    reasons: list[str] = []

    def remember(_: int, text: Any) -> None:
        reasons.append(text.decode(errors="replace"))

    glfw.set_error_callback(remember)
    if glfw.init():
        for hint, value in (
            (glfw.CONTEXT_VERSION_MAJOR, OPENGL_VERSION[0]),
            (glfw.CONTEXT_VERSION_MINOR, OPENGL_VERSION[1]),
            (glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE),
            (glfw.OPENGL_FORWARD_COMPAT, True),
            (glfw.DEPTH_BITS, 0),  # nothing here needs them, and a processor that draws would clear them every time
            (glfw.STENCIL_BITS, 0),
        ):
            glfw.window_hint(hint, value)
        handle = glfw.create_window(*size, title, None, None)
        if handle:
            glfw.make_context_current(handle)
            glfw.swap_interval(1)
            return handle
    why = reasons[-1] if reasons else "no reason given"
    raise InputError(f"no window can be opened ({why}); without a display, write a picture: --output=FILE.png")


def _modifiers(bits: int) -> frozenset[str]:
    return frozenset(name for bit, name in _MODIFIERS.items() if bits & bit)


def _held_modifiers(window: Any) -> frozenset[str]:
    """The modifiers that are held down; glfw tells of them only with keys and buttons."""
    keys = {
        "Ctrl": (glfw.KEY_LEFT_CONTROL, glfw.KEY_RIGHT_CONTROL),
        "Shift": (glfw.KEY_LEFT_SHIFT, glfw.KEY_RIGHT_SHIFT),
        "Alt": (glfw.KEY_LEFT_ALT, glfw.KEY_RIGHT_ALT),
    }
    return frozenset(name for name, codes in keys.items() if any(glfw.get_key(window, code) for code in codes))
