//! A session without a window: it draws into memory, and tests press its keys.

use std::cell::{Ref, RefCell};
use std::collections::VecDeque;
use std::rc::Rc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender as Channel, channel};
use std::time::{Duration, Instant};

use egui::accesskit::TreeUpdate;
use egui::{CursorIcon, Rect};
use image::RgbaImage;

use mariana::clock;
use mariana::commands::{Command, Sender, ShowState};
use mariana::gpu::{Gl, GpuError, Headless, Renderer, Target, WorkerContext};
use mariana::input::Input;
use mariana::monitor::Monitor;
use mariana::placement::Area;
use mariana::session::desktop::DesktopControls;
use mariana::session::{Event, Lay, Opening, Paint, Prepared, Run, Screen, SessionError, Waker};
use mariana::ui::overlay::PanelSwitches;
use mariana_player::PlayerStatus;

const FPS: f64 = 60.0;
const PATIENCE: Duration = Duration::from_millis(20);

/// A session that draws into memory. It stays on the thread that created it.
pub(crate) struct Offscreen {
    /// `None` after an error.
    run: Option<Run>,
    shared: Rc<RefCell<WindowState>>,
}

/// What the window shows.
pub(crate) struct WindowState {
    size: (u32, u32),
    events: VecDeque<Event>,
    /// The window's title.
    pub(crate) title: String,
    fullscreen: bool,
    /// The pointer's shape.
    pub(crate) cursor: CursorIcon,
    /// True while text is composed.
    pub(crate) composes: bool,
    controls: Option<TreeUpdate>,
    /// Number of frames so far.
    pub(crate) shown: u64,
    is_due: bool,
    /// The last frame with its panels.
    pub(crate) picture: RgbaImage,
}

impl Offscreen {
    /// Starts a prepared session. The window has the size in the settings; programs are compiled between frames.
    ///
    /// # Errors
    /// Fails if the scene or the song cannot be shown, or there is no OpenGL context.
    pub(crate) fn open(prepared: Prepared) -> Result<Self, SessionError> {
        Self::begin(prepared, false)
    }

    /// Starts a session with a compiler thread on EGL's default display. Without EGL, it compiles between frames.
    ///
    /// # Errors
    /// Fails for the same reasons as [`Offscreen::open`].
    pub(crate) fn open_with_compiler(prepared: Prepared) -> Result<Self, SessionError> {
        Self::begin(prepared, true)
    }

    fn begin(prepared: Prepared, has_compiler: bool) -> Result<Self, SessionError> {
        let started = clock::now();
        let (wakes, woken) = channel();
        let waker = Waker::new(move || {
            // Sending fails after the end of the session.
            let _ = Channel::send(&wakes, ());
        });
        let size = prepared.settings.size;
        let opening = Opening::start(prepared, &waker)?;
        let (screen, shared) = OffscreenWindow::new(size, woken, has_compiler)?;
        let run = opening.run(Box::new(screen), |_| Box::new(NoDesktop), waker, started)?;
        Ok(Self { run: Some(run), shared })
    }

    /// Runs one step: input, a brief wait for due work, drawing. Replaces a lost context. Returns `false` at the end.
    ///
    /// # Errors
    /// Fails if an error ends the session.
    pub(crate) fn step(&mut self) -> Result<bool, SessionError> {
        let Some(mut run) = self.run.take() else { return Ok(false) };
        match run.step() {
            Err(error) if run.can_go_on_after(&error) => run = run.renewed()?,
            done => done?,
        }
        let goes_on = !run.over;
        self.run = Some(run);
        Ok(goes_on)
    }

    /// Queues input for the next step.
    pub(crate) fn send(&mut self, input: Input) {
        self.shared.borrow_mut().events.push_back(Event::Input(input));
    }

    /// Carries out a command at once.
    pub(crate) fn command(&mut self, command: Command) {
        if let Some(run) = &mut self.run {
            run.carry_out(command, Sender::Window);
        }
    }

    /// Changes the size of the window, in pixels.
    pub(crate) fn resize(&mut self, size: (u32, u32)) {
        let mut shared = self.shared.borrow_mut();
        (shared.size, shared.is_due) = (size, true);
    }

    /// What the window shows now.
    pub(crate) fn window(&self) -> Ref<'_, WindowState> {
        self.shared.borrow()
    }

    /// The state of everything that a named command can change.
    pub(crate) fn state(&mut self) -> ShowState {
        self.run.as_mut().map(|run| run.state()).unwrap_or_default()
    }

    /// The panels that the user has opened.
    pub(crate) fn panels(&self) -> PanelSwitches {
        self.run.as_ref().map(|run| run.panels()).unwrap_or_default()
    }

    /// Returns `true` once an idle show is drawn in its best quality. A frozen frame is always at rest.
    pub(crate) fn is_at_rest(&self) -> bool {
        self.run.as_ref().is_none_or(|run| run.is_at_rest())
    }

    /// Ends the session as a user would, and saves its state.
    pub(crate) fn finish(mut self) {
        if let Some(run) = &mut self.run {
            run.finish();
        }
    }
}

struct OffscreenWindow {
    target: Target,
    shared: Rc<RefCell<WindowState>>,
    woken: Receiver<()>,
    has_compiler: bool,
    // The last field: the target belongs to the context and must be dropped first.
    context: Headless,
}

impl OffscreenWindow {
    fn new(
        size: (u32, u32),
        woken: Receiver<()>,
        has_compiler: bool,
    ) -> Result<(Self, Rc<RefCell<WindowState>>), SessionError> {
        let context = Headless::new(false)?;
        let target = target_of(context.gl(), size)?;
        let shared = Rc::new(RefCell::new(WindowState {
            size,
            events: VecDeque::new(),
            title: String::new(),
            fullscreen: false,
            cursor: CursorIcon::Default,
            composes: false,
            controls: None,
            shown: 0,
            is_due: true,
            picture: RgbaImage::new(size.0, size.1),
        }));
        Ok((Self { target, shared: shared.clone(), woken, has_compiler, context }, shared))
    }

    fn fit(&mut self) -> Result<(u32, u32), SessionError> {
        let size = self.shared.borrow().size;
        if self.target.size() != size {
            self.target = target_of(self.context.gl(), size)?;
        }
        Ok(size)
    }

    fn present(&self) {
        let (width, height) = self.target.size();
        let picture = RgbaImage::from_raw(width, height, self.target.read_rgba8(0)).unwrap_or_default();
        let mut shared = self.shared.borrow_mut();
        shared.picture = picture;
        shared.shown += 1;
    }
}

fn target_of(gl: &Gl, size: (u32, u32)) -> Result<Target, GpuError> {
    let target = Target::of_window(gl, size)?;
    gl.replace_window(Some(&target));
    Ok(target)
}

impl Screen for OffscreenWindow {
    fn wait(&mut self, until: Instant) -> Vec<Event> {
        let patience = until.saturating_duration_since(clock::now()).min(PATIENCE);
        let is_idle = {
            let shared = self.shared.borrow();
            shared.events.is_empty() && !shared.is_due
        };
        if is_idle && let Err(RecvTimeoutError::Disconnected) = self.woken.recv_timeout(patience) {
            return vec![Event::End];
        }
        while self.woken.try_recv().is_ok() {}
        let mut shared = self.shared.borrow_mut();
        // Take one event per step, so that the effect of each key is drawn before the next key.
        let events: Vec<Event> = shared.events.pop_front().into_iter().collect();
        let redraw = std::mem::take(&mut shared.is_due).then_some(Event::Redraw);
        events.into_iter().chain(redraw).collect()
    }

    fn gl(&self) -> &Gl {
        self.context.gl()
    }

    fn worker_contexts(&self, _: usize) -> Vec<WorkerContext> {
        self.has_compiler.then(WorkerContext::beside_headless).flatten().into_iter().collect()
    }

    fn renew(self: Box<Self>) -> Result<Box<dyn Screen>, SessionError> {
        let Self { target, shared, woken, has_compiler, context } = *self;
        drop(target);
        drop(context);
        let context = Headless::new(false)?;
        let target = target_of(context.gl(), shared.borrow().size)?;
        Ok(Box::new(Self { target, shared, woken, has_compiler, context }))
    }

    fn refresh_rate(&self) -> Option<f64> {
        Some(FPS)
    }

    fn size(&self) -> Option<(u32, u32)> {
        Some(self.shared.borrow().size)
    }

    fn picture_size(&self) -> Option<(u32, u32)> {
        self.size()
    }

    fn is_fullscreen(&self) -> bool {
        self.shared.borrow().fullscreen
    }

    fn set_fullscreen(&mut self, on: bool) {
        self.shared.borrow_mut().fullscreen = on;
    }

    fn set_title(&mut self, title: &str) {
        title.clone_into(&mut self.shared.borrow_mut().title);
    }

    fn set_cursor(&mut self, cursor: CursorIcon) {
        self.shared.borrow_mut().cursor = cursor;
    }

    fn allow_composing(&mut self, on: bool) {
        self.shared.borrow_mut().composes = on;
    }

    fn show_controls(&mut self, controls: TreeUpdate) {
        self.shared.borrow_mut().controls = Some(controls);
    }

    fn request_redraw(&self) {
        // `shared` is already borrowed if this is called while a frame is shown.
        if let Ok(mut shared) = self.shared.try_borrow_mut() {
            shared.is_due = true;
        }
    }

    fn show(
        &mut self,
        renderer: &mut Renderer,
        lay: &Lay,
        small: Option<Area>,
        _: bool,
        paint: Paint<'_>,
    ) -> Result<Duration, SessionError> {
        let begun = Instant::now();
        let size = self.fit()?;
        match small {
            Some(area) => lay.show_small(renderer, size, area)?,
            None => lay.show(renderer, size, lay.area_in(size))?,
        }
        paint(size)?;
        self.present();
        Ok(begun.elapsed())
    }

    fn show_waiting(&mut self, paint: Paint<'_>) -> Result<(), SessionError> {
        let size = self.fit()?;
        self.context.gl().clear_window(size, [0.0; 3])?;
        paint(size)?;
        self.present();
        Ok(())
    }

    fn scale(&self) -> f32 {
        1.0
    }

    fn place(&self) -> Option<(i32, i32)> {
        None
    }

    fn raise(&mut self) {}

    fn set_place_of_letters(&mut self, _: Rect) {}

    fn set_keys_are_text(&mut self, _: bool) {}

    fn is_seen(&self) -> bool {
        true
    }

    fn shows_words(&self) -> bool {
        true
    }

    fn is_awaited(&self) -> bool {
        false
    }

    fn is_stale(&self) -> bool {
        false
    }

    fn has_output(&self) -> bool {
        false
    }

    fn keep_awake(&mut self, _: bool) {}

    fn update(&mut self) -> Vec<String> {
        Vec::new()
    }

    fn monitors(&self) -> Vec<Monitor> {
        Vec::new()
    }

    fn update_monitors(&mut self) {}

    fn request_output(&mut self, _: Option<String>) {}

    fn lie_differently(&mut self) {
        self.request_redraw();
    }

    fn show_on_output(&mut self, _: &mut Renderer, _: &Lay, _: bool) -> Result<(), SessionError> {
        Ok(())
    }
}

struct NoDesktop;

impl DesktopControls for NoDesktop {
    fn poll(&self) -> Option<Command> {
        None
    }

    fn show(&self, _: &PlayerStatus, _: bool, _: bool) {}
}
