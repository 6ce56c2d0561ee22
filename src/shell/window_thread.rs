//! The window's thread: receives the window's events and passes them to the show, which runs on a separate thread.
//!
//! A driver, a disk or a device can block only the show; this thread waits only for events. Therefore the window always
//! answers its window system and quits at once, however long a driver compiles.

use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use accesskit_winit::Adapter;
use winit::application::ApplicationHandler;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Window, WindowId};

use crate::commands::Command;
use crate::ending::{self, Signal};
use crate::export::print::print_message;
use crate::input::Modifiers;
use crate::session::SessionError;
#[cfg(all(unix, not(target_os = "macos")))]
use crate::shell::idle::surface::SurfaceInhibitor;
use crate::shell::messages::{Message, Typing, WindowMessage, may_open_text};
use crate::shell::monitors::Monitor;
use crate::shell::translate::{input_of, key_press, modifiers};
use crate::shell::wallpaper::Layers;
use crate::shell::window::{OpenWindow, WindowOptions, open_output, refused, shared};

/// Longest wait at the end for a show that a driver blocks.
const END_WAIT: Duration = Duration::from_secs(3);
/// Longest wait for a show that has saved everything: only its compilers are still busy. The process then ends without
/// freeing what they use.
const SAVED_WAIT: Duration = Duration::from_millis(200);

pub(crate) type Play = Box<dyn FnOnce(OpenWindow) -> Result<(), SessionError> + Send>;

/// Opens a window and runs `play` on a separate thread, which gets the events through `messages`. Returns when `play`
/// or the window ends. `typing` is true while keys type text. `layers`, if given, show the frame instead of the window.
pub(crate) fn run(
    event_loop: EventLoop<WindowMessage>,
    input_queue: WindowOptions,
    messages: Sender<Message>,
    typing: Typing,
    layers: Option<Layers>,
    play: Play,
) -> Result<(), SessionError> {
    let on_signal = event_loop.create_proxy();
    let watched = ending::watch(move |_| {
        let _ = on_signal.send_event(WindowMessage::End);
    });
    if let Err(error) = watched {
        tracing::info!("signals cannot be caught and end the show at once ({error})");
    }
    let mut front = Front {
        proxy: event_loop.create_proxy(),
        messages,
        begins_with: Some((input_queue, play)),
        running: None,
        ends_by: None,
        show_ended: false,
        held: Modifiers::empty(),
        monitors: Vec::new(),
        typing,
        layers,
        result: Ok(()),
    };
    #[cfg(all(unix, not(target_os = "macos")))]
    crate::shell::lost_display::end_with_the_reason();
    event_loop.run_app(&mut front).map_err(|error| refused("to run", &error))?;
    front.result
}

struct Front {
    proxy: EventLoopProxy<WindowMessage>,
    messages: Sender<Message>,
    /// `None` once the window has been opened.
    begins_with: Option<(WindowOptions, Play)>,
    running: Option<Running>,
    /// The time until which the thread waits for the show; set at the end.
    ends_by: Option<Instant>,
    show_ended: bool,
    held: Modifiers,
    monitors: Vec<Monitor>,
    typing: Typing,
    layers: Option<Layers>,
    result: Result<(), SessionError>,
}

struct Running {
    show: JoinHandle<Result<(), SessionError>>,
    #[cfg(all(unix, not(target_os = "macos")))]
    inhibitor: Option<SurfaceInhibitor>,
    // Dropped here, after the show's end, on the thread that created them.
    accessibility: Adapter,
    window: Arc<Window>,
    config: glutin::config::Config,
    output: Option<Arc<Window>>,
}

impl Front {
    fn open(&mut self, event_loop: &ActiveEventLoop) -> Result<(), SessionError> {
        let Some((input_queue, play)) = self.begins_with.take() else { return Ok(()) };
        let (opened, window) = OpenWindow::open(event_loop, &self.proxy, &input_queue)?;
        let (visible, config) = (input_queue.visible, opened.config.clone());
        // It does nothing until assistive technology connects.
        let accessibility = Adapter::with_event_loop_proxy(event_loop, &window, self.proxy.clone());
        window.set_visible(visible);
        let proxy = self.proxy.clone();
        let show = move || {
            // Reports the end of the show, even after a panic.
            let _tells = EndNotifier(proxy);
            play(opened)
        };
        let thread = std::thread::Builder::new().name("show".into());
        let show = thread.spawn(show).map_err(|error| SessionError::NoThread(error.to_string()))?;
        self.running = Some(Running {
            show,
            #[cfg(all(unix, not(target_os = "macos")))]
            inhibitor: SurfaceInhibitor::of(event_loop, &window),
            accessibility,
            window,
            config,
            output: None,
        });
        Ok(())
    }

    /// Exits the process if the end takes longer than [`END_WAIT`]: winit waits for a last reply of the compositor,
    /// which never comes from a compositor that hangs.
    fn leave_in_time(&self) {
        let words = self.result.as_ref().err().map(ToString::to_string);
        let leave = move || {
            std::thread::sleep(END_WAIT);
            let leaving = ending::begin_to_leave();
            let asked = ending::asked_to_end().map_or(0, Signal::exit_code);
            let code = words.map_or(asked, |words| {
                print_message(&words);
                1
            });
            leaving.leave(code)
        };
        if let Err(error) = std::thread::Builder::new().name("end".into()).spawn(leave) {
            tracing::info!("the wait for the window system has no limit: {error}");
        }
    }

    /// Asks the show to end. Hides the windows at once, even if the show still waits for a driver.
    fn end(&mut self, event_loop: &ActiveEventLoop) {
        if self.ends_by.is_some() {
            return;
        }
        let Some(running) = &self.running else { return event_loop.exit() };
        for window in std::iter::once(&running.window).chain(&running.output) {
            window.set_visible(false);
        }
        let _ = self.messages.send(Message::End);
        self.end_after(END_WAIT, event_loop);
    }

    /// Ends the event loop after `wait`, unless it ends before.
    fn end_after(&mut self, wait: Duration, event_loop: &ActiveEventLoop) {
        let until = Instant::now() + wait;
        let until = self.ends_by.map_or(until, |known| known.min(until));
        self.ends_by = Some(until);
        event_loop.set_control_flow(ControlFlow::WaitUntil(until));
    }
}

/// True if an event ends the program, which must not wait for the show.
fn asks_for_the_end(event: &WindowEvent, held: Modifiers, typing: bool) -> bool {
    match event {
        // `Destroyed`: another program has closed the window.
        WindowEvent::CloseRequested | WindowEvent::Destroyed => true,
        WindowEvent::KeyboardInput { event, is_synthetic: false, .. } => {
            key_press(event).is_some_and(|press| {
                !typing && Command::of_key(&press.key, held, press.repeat) == Some(Command::Quit)
            })
        }
        _ => false,
    }
}

impl ApplicationHandler<WindowMessage> for Front {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if let Err(error) = self.open(event_loop) {
            self.result = Err(error);
            event_loop.exit();
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, window: WindowId, event: WindowEvent) {
        let output = self.running.as_ref().and_then(|running| running.output.as_ref());
        // Keys in any window belong to the show.
        let is_key = matches!(event, WindowEvent::KeyboardInput { .. } | WindowEvent::ModifiersChanged(_));
        if output.is_some_and(|output| output.id() == window) && !is_key {
            if self.ends_by.is_none() {
                let _ = self.messages.send(Message::OutputEvent(event));
            }
            return;
        }
        if !is_key && self.running.as_ref().is_some_and(|running| running.window.id() != window) {
            // A late event of a closed output.
            return;
        }
        if let WindowEvent::ModifiersChanged(held) = &event {
            self.held = modifiers(held.state());
        }
        if let Some(running) = &mut self.running {
            running.accessibility.process_event(&running.window, &event);
        }
        if asks_for_the_end(&event, self.held, self.typing.is_on()) {
            return self.end(event_loop);
        }
        if self.ends_by.is_none() {
            if input_of(&event).is_some_and(|input| may_open_text(&input)) {
                self.typing.send_key();
            }
            let _ = self.messages.send(Message::Window(event));
        }
    }

    fn user_event(&mut self, event_loop: &ActiveEventLoop, reported: WindowMessage) {
        match reported {
            WindowMessage::Ended => {
                self.show_ended = true;
                event_loop.exit();
            }
            WindowMessage::Saved => self.end_after(SAVED_WAIT, event_loop),
            WindowMessage::End => self.end(event_loop),
            WindowMessage::Assistance(assistance) => {
                let _ = self.messages.send(Message::Assistance(assistance));
            }
            WindowMessage::OpenOutput(monitor) => {
                let Some(running) = self.running.as_mut().filter(|_| self.ends_by.is_none()) else { return };
                let opened = open_output(event_loop, &running.config, &monitor)
                    .and_then(|window| Ok((window.clone(), shared(event_loop, &self.proxy, window)?)));
                match opened {
                    Ok((own, window)) => {
                        running.output = Some(own);
                        let _ = self.messages.send(Message::Output(window));
                    }
                    Err(error) => tracing::warn!("{error}"),
                }
            }
            // Nothing to do: winit has read the queued events before it passes on this message.
            WindowMessage::CallsMade => {}
            #[cfg_attr(
                any(windows, target_os = "macos"),
                expect(unused_variables, reason = "only Wayland asks")
            )]
            WindowMessage::KeepAwake(on) => {
                #[cfg(all(unix, not(target_os = "macos")))]
                if let Some(inhibitor) = self.running.as_mut().and_then(|running| running.inhibitor.as_mut())
                {
                    inhibitor.set(on);
                }
            }
            WindowMessage::CloseOutput => {
                if let Some(running) = &mut self.running {
                    running.output = None;
                }
            }
            WindowMessage::Controls(controls) => {
                if let Some(running) = &mut self.running {
                    running.accessibility.update_if_active(|| *controls);
                }
            }
        }
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        if let Some(monitors) = monitors_of_wayland(event_loop)
            && self.monitors != monitors
        {
            self.monitors.clone_from(&monitors);
            let _ = self.messages.send(Message::Monitors(monitors));
        }
        if self.ends_by.is_some_and(|until| Instant::now() >= until) {
            tracing::info!("a driver blocks the show: the program ends without waiting for it");
            event_loop.exit();
        }
    }

    fn exiting(&mut self, _event_loop: &ActiveEventLoop) {
        let Some(running) = self.running.take() else { return };
        #[cfg(all(unix, not(target_os = "macos")))]
        drop(running.inhibitor);
        let Running { show, accessibility, window, output, .. } = running;
        if !self.show_ended && self.ends_by.is_none() {
            // The window system has ended the event loop, and the show may wait for it forever.
            end_without_display();
        }
        while !show.is_finished() && self.ends_by.is_some_and(|until| Instant::now() < until) {
            std::thread::sleep(Duration::from_millis(1));
        }
        if !show.is_finished() && self.ends_by.is_some_and(|until| Instant::now() >= until) {
            // Exit here: after this function, the event loop closes the connection through which the show still draws.
            ending::begin_to_leave().leave(ending::asked_to_end().map_or(0, Signal::exit_code));
        }
        self.result = show.join().unwrap_or_else(|_| {
            Err(refused("to continue", &"the show panicked; please report the message above"))
        });
        // Dropped after the show, which draws into them.
        self.layers = None;
        drop(accessibility);
        drop(output);
        drop(window);
        self.leave_in_time();
    }
}

/// Returns the monitors on Wayland, from left to right; `None` on other window systems.
#[cfg(all(unix, not(target_os = "macos")))]
fn monitors_of_wayland(event_loop: &ActiveEventLoop) -> Option<Vec<Monitor>> {
    use winit::platform::wayland::ActiveEventLoopExtWayland;
    if !event_loop.is_wayland() {
        return None;
    }
    let known = |monitor: winit::monitor::MonitorHandle| {
        let (place, size) = (monitor.position().into(), monitor.size().into());
        Some(Monitor { name: monitor.name()?, place, size })
    };
    let mut monitors: Vec<Monitor> = event_loop.available_monitors().filter_map(known).collect();
    monitors.sort_by_key(|monitor| monitor.place);
    Some(monitors)
}

#[cfg(not(all(unix, not(target_os = "macos"))))]
fn monitors_of_wayland(_event_loop: &ActiveEventLoop) -> Option<Vec<Monitor>> {
    None
}

/// Ends the process with a message after the display was lost.
pub(crate) fn end_without_display() -> ! {
    let leaving = ending::begin_to_leave();
    print_message(&SessionError::DisplayLost.to_string());
    leaving.leave(1)
}

/// Tells the event loop, when dropped, that the show has ended.
struct EndNotifier(EventLoopProxy<WindowMessage>);

impl Drop for EndNotifier {
    fn drop(&mut self) {
        // Sending fails only if the event loop has ended already.
        let _ = self.0.send_event(WindowMessage::Ended);
    }
}
