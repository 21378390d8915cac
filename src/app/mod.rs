//! The shell: window, panels, commands, command line; the only room that knows everyone.
