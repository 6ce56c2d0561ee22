# Print an optspec for argparse to handle cmd's options that are independent of any subcommand.
function __fish_mariana_global_optspecs
    string join \n mic system shuffle repeat= device= silent once volume= latency= fps-cap= fade= fullscreen clean size= show= osc= osc-send= osc-rate= midi= remote= new new-window prepare-ahead= program-cache= gl-info quality= flash-limiter= brightness= blackout-fade= flip= crop= corners= output= wallpaper send= send-size= send-fps= scene= view= projection= stereo= eye-distance= dome-tilt= sdf= regions= tone-map= gain= shaders= v/verbose h/help V/version
end

function __fish_mariana_needs_command
    # Figure out if the current invocation already has a command.
    set -l cmd (commandline -opc)
    set -e cmd[1]
    argparse -s (__fish_mariana_global_optspecs) -- $cmd 2>/dev/null
    or return
    if set -q argv[1]
        # Also print the command, so this can be used to figure out what it is.
        echo $argv[1]
        return 1
    end
    return 0
end

function __fish_mariana_using_subcommand
    set -l cmd (__fish_mariana_needs_command)
    test -z "$cmd"
    and return 1
    contains -- $cmd[1] $argv
end

complete -c mariana -n "__fish_mariana_needs_command" -l repeat -d 'Tracks to repeat' -r -f -a "all\t'All tracks, over and over'
one\t'One track, over and over'
off\t'Each track once; the window stays open'"
complete -c mariana -n "__fish_mariana_needs_command" -l device -d 'Output device, or input with --mic and --system: an id or name from \'mariana devices\', a part of an id or name, or \'default\' for the system\'s device [default: the last choice in the window, at first the system\'s device]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l volume -d 'Volume at the start, in percent [default: the last volume, at first 100]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l latency -d 'Additional delay of the sound, beyond the delay that the device reports; negative for less [default: the last delay set with the keys [ and ]]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l fps-cap -d 'Maximum frames per second [default: the monitor\'s rate]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l fade -d 'Duration of the fade between scenes with N and P, in seconds; 0 cuts' -r
complete -c mariana -n "__fish_mariana_needs_command" -l size -d 'Size of the window in pixels [default: the last size, at first 1280x720]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l show -d 'Let a show change the scenes: \'auto\' to follow the song, \'off\', or a .show file [default: the last choice in the window, at first auto unless a scene is named]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l osc -d 'Receive OSC messages on this port from this computer only, or on a network address given as ADDRESS:PORT; docs/osc.md lists the messages' -r
complete -c mariana -n "__fish_mariana_needs_command" -l osc-send -d 'Send the features of the sound to another program or to lights, by OSC' -r
complete -c mariana -n "__fish_mariana_needs_command" -l osc-rate -d 'OSC messages sent per second' -r
complete -c mariana -n "__fish_mariana_needs_command" -l midi -d 'Listen to MIDI devices; key J maps them' -r -f -a "on\t''
off\t''"
complete -c mariana -n "__fish_mariana_needs_command" -l remote -d 'Serve a page that lets phones on the network control the show, on this port, or only on a network address given as ADDRESS:PORT. Key J shows the code to scan; docs/remote.md describes the protection' -r
complete -c mariana -n "__fish_mariana_needs_command" -l prepare-ahead -d 'Prepare the next and the previous scene while the current scene is shown' -r -f -a "on\t''
off\t''"
complete -c mariana -n "__fish_mariana_needs_command" -l program-cache -d 'Keep the driver\'s compiled programs in the user\'s cache folder' -r -f -a "on\t''
off\t''"
complete -c mariana -n "__fish_mariana_needs_command" -l quality -d 'Quality of the image; auto lowers the resolution when frames take too long [default: the setting in the window, initially auto]' -r -f -a "auto\t'The best that keeps the frame rate'
low\t'About half the window\'s width and height'
medium\t''
high\t''
best\t'Full resolution and all effects, at any frame rate'"
complete -c mariana -n "__fish_mariana_needs_command" -l flash-limiter -d 'Dim more than three flashes a second, as WCAG 2.3.1 requires [default: the setting in the window, initially on]' -r -f -a "on\t''
off\t''"
complete -c mariana -n "__fish_mariana_needs_command" -l brightness -d 'Brightness of the image in the window, in percent [default: the value in the settings, initially 100]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l blackout-fade -d 'Duration of a blackout fade (key X), and of the return from a frozen image (key Z), in seconds [default: the setting in the window, initially 0.5]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l flip -d 'Mirror the image in the window, for projectors [default: the value in the settings, initially off]' -r -f -a "off\t''
horizontal\t'For rear projection'
vertical\t''
both\t'For a projector mounted upside down'"
complete -c mariana -n "__fish_mariana_needs_command" -l crop -d 'Crop of each edge of the image in the window, in percent; the rest fills the window, unstretched [default: the last setting, initially 0,0,0,0]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l corners -d 'Positions of the image\'s corners in the window, in percent to the right and down, clockwise from the upper left, for a projector at an angle. \'off\' uses the window\'s corners [default: the corners set with key Y]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l output -d 'Show the image without panels on a whole monitor, given by name or number, in addition to the window; \'list\' lists the monitors, \'off\' uses none [default: the last choice in the window]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l send -d 'Send the frames to another program: y4m:FIFO, y4m:- (standard output), mjpeg:PORT (HTTP on this machine, for OBS or a browser) or v4l2:/dev/videoN (a camera by v4l2loopback); can be given more than once' -r
complete -c mariana -n "__fish_mariana_needs_command" -l send-size -d 'Size of the frames that are sent [default: the window\'s size at the start]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l send-fps -d 'Frames sent per second' -r
complete -c mariana -n "__fish_mariana_needs_command" -l scene -d 'The scene to show: a file, the name of a shipped scene (\'mariana scenes\' lists them), or a formula such as "length(p) - 1" [default: speakers]' -r -a "barth cathedral city clockwork cloud_sea fireflies first_steps forest glass_organ gyroid heart ink kaleidoscope lattice lava_lamp letters library mandelbulb marbling metaballs moonrise nave orb quadric rain reef speakers spiral terrain tunnel village wave_tank wax_world"
complete -c mariana -n "__fish_mariana_needs_command" -l view -d 'Show a view of the rendering process, with a legend: - steps: steps of the ray from the eye, blue to red; steps:NUMBER sets the count shown in red, 100 by default - slice: the distance on a plane through the camera\'s target, as lines; slice:NUMBER sets the distance between two lines - normals: normals of the surfaces, by finite differences of the distance; normals:NUMBER sets the step of the differences, by default a fraction of a pixel - shadow: the fraction of direct light that arrives - occlusion: the fraction of the ambient light that arrives - clauses: clauses that the interpreter runs; distance evaluations if compiled; clauses:NUMBER sets the count shown in red - cells: the cells of the regions, and the lengths of their tapes - materials: a colour for each object - depth: the distance to the surface; depth:NUMBER sets the distance shown in black ' -r
complete -c mariana -n "__fish_mariana_needs_command" -l projection -d 'Projection: for players of 360-degree videos, planetariums and headsets' -r -f -a "flat\t''
360\t'The whole sphere, twice as wide as high'
dome\t'A square dome master: a disc of 180 degrees'
vr180\t'The half in front of the camera, square'"
complete -c mariana -n "__fish_mariana_needs_command" -l stereo -d 'Pictures for two eyes' -r -f -a "none\t''
side-by-side\t'The left eye on the left'
over-under\t'The left eye above'"
complete -c mariana -n "__fish_mariana_needs_command" -l eye-distance -d 'Distance of the eyes in the scene\'s units; larger distances make the scene look smaller' -r
complete -c mariana -n "__fish_mariana_needs_command" -l dome-tilt -d 'Height of the camera\'s target in a dome, in degrees above the front rim; 90 is the zenith [default: 45]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l sdf -d 'Interpret or compile the scene\'s formulas; auto interprets at once and compiles in the background' -r -f -a "interpreted\t''
compiled\t''
auto\t''"
complete -c mariana -n "__fish_mariana_needs_command" -l regions -d 'Skip empty space with a tree of cells and run a shortened tape in each cell; the image is the same [default: on where that is faster; bench measures both]' -r -f -a "on\t''
off\t''"
complete -c mariana -n "__fish_mariana_needs_command" -l tone-map -d 'Conversion of light to screen colours [default: the scene\'s own, or in a window the last choice there]' -r -f -a "scene\t'The scene\'s own choice'
agx\t'Natural colours; bright colours fade to white, as on film'
aces\t'Deep shadows and vivid colours'
reinhard\t'Gentle highlights'
none\t'Light as it is; all that is too bright becomes white'"
complete -c mariana -n "__fish_mariana_needs_command" -l gain -d 'Automatic gain: quiet and loud songs move the image by the same amount; values in decibels are never changed [default: auto, or in a window the last choice there]' -r -f -a "auto\t''
off\t''"
complete -c mariana -n "__fish_mariana_needs_command" -l shaders -d 'Read the shaders from this folder, to work on them' -r -F
complete -c mariana -n "__fish_mariana_needs_command" -l mic -d 'Show the sound of a microphone or another input, instead of a song'
complete -c mariana -n "__fish_mariana_needs_command" -l system -d 'Show the sound that the computer plays, instead of a song'
complete -c mariana -n "__fish_mariana_needs_command" -l shuffle -d 'Play the tracks in random order'
complete -c mariana -n "__fish_mariana_needs_command" -l silent -d 'Play without sound, in real time'
complete -c mariana -n "__fish_mariana_needs_command" -l once -d 'Exit after the last track instead of starting over'
complete -c mariana -n "__fish_mariana_needs_command" -l fullscreen -d 'Start in full screen'
complete -c mariana -n "__fish_mariana_needs_command" -l clean -d 'Show only requested panels and errors over the image: no hints, messages or bar'
complete -c mariana -n "__fish_mariana_needs_command" -l new -d 'Do not continue the last show, and do not save this show; choices from the settings panel still apply'
complete -c mariana -n "__fish_mariana_needs_command" -l new-window -d 'Open a window even if Mariana is running. Without options, the running one opens the files'
complete -c mariana -n "__fish_mariana_needs_command" -l gl-info -d 'Print the available OpenGL version, and exit'
complete -c mariana -n "__fish_mariana_needs_command" -l wallpaper -d 'Be the desktop\'s wallpaper, on X11 or on Wayland with layer shell: below all windows, on all monitors, without input; at most 30 frames a second unless --fps-cap is given. Pauses drawing while covered and on battery. Media keys pause the song'
complete -c mariana -n "__fish_mariana_needs_command" -s v -l verbose -d 'Log what the program does; twice for more'
complete -c mariana -n "__fish_mariana_needs_command" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c mariana -n "__fish_mariana_needs_command" -s V -l version -d 'Print version'
complete -c mariana -n "__fish_mariana_needs_command" -a "still" -d 'Render one moment of a song to a PNG, JPEG or WebP, without a window or a sound card'
complete -c mariana -n "__fish_mariana_needs_command" -a "video" -d 'Render a part of a song to a video (needs ffmpeg) or to numbered stills'
complete -c mariana -n "__fish_mariana_needs_command" -a "analyze" -d 'Print the features of a song, one line for each frame'
complete -c mariana -n "__fish_mariana_needs_command" -a "bench" -d 'Measure frame times and distance evaluations, without a window'
complete -c mariana -n "__fish_mariana_needs_command" -a "check" -d 'Check scenes: print each mistake with its position, or the cost of the scene'
complete -c mariana -n "__fish_mariana_needs_command" -a "format" -d 'Format scene files; the scenes stay the same'
complete -c mariana -n "__fish_mariana_needs_command" -a "lsp" -d 'Run the language server for editors, on standard input and output'
complete -c mariana -n "__fish_mariana_needs_command" -a "tape" -d 'Print the tape of a scene\'s distance: the clauses that the interpreter runs'
complete -c mariana -n "__fish_mariana_needs_command" -a "eval" -d 'Evaluate a scene\'s distance at points, one number per line'
complete -c mariana -n "__fish_mariana_needs_command" -a "import" -d 'Make a scene from a shader in GLSL, such as one from Shadertoy'
complete -c mariana -n "__fish_mariana_needs_command" -a "export" -d 'Write a scene\'s distance and colours as GLSL, for example for Shadertoy'
complete -c mariana -n "__fish_mariana_needs_command" -a "show" -d 'Write the director\'s show for a song to a show file, for editing'
complete -c mariana -n "__fish_mariana_needs_command" -a "mesh" -d 'Write the surfaces of a moment as triangles, for Blender and for printing'
complete -c mariana -n "__fish_mariana_needs_command" -a "page" -d 'Write a web page that plays a song with a show or a scene, in one file'
complete -c mariana -n "__fish_mariana_needs_command" -a "scenes" -d 'List the shipped scenes with their descriptions'
complete -c mariana -n "__fish_mariana_needs_command" -a "devices" -d 'List the sound systems with their inputs and outputs, and the formats of these devices'
complete -c mariana -n "__fish_mariana_needs_command" -a "help" -d 'Print this message or the help of the given subcommand(s)'
complete -c mariana -n "__fish_mariana_using_subcommand still" -l at -d 'The moment, as 80 or 1:20.5' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -l for -d 'Use the size of a service; --size overrides it' -r -f -a "youtube\t'1920x1080 at 60 frames a second'
4k\t'3840x2160 at 30 frames a second'
shorts\t'Portrait, 1080x1920 at 30 frames a second, the first 180 seconds'
tiktok\t'Portrait, 1080x1920 at 30 frames a second'
reel\t'Portrait, 1080x1920 at 30 frames a second, the first 90 seconds'
story\t'Portrait, 1080x1920 at 30 frames a second, the first 60 seconds'
square\t'1080x1080 at 30 frames a second'
loop\t'Portrait, 1080x1920 at 30 frames a second; 8 seconds without sound whose end fades into the beginning'"
complete -c mariana -n "__fish_mariana_using_subcommand still" -l size -d 'Size of the whole picture in pixels, with both eyes of --stereo [default: 1280x720, or set by --for, --projection and --stereo]' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -l projection -d 'Projection: for players of 360-degree videos, planetariums and headsets' -r -f -a "flat\t''
360\t'The whole sphere, twice as wide as high'
dome\t'A square dome master: a disc of 180 degrees'
vr180\t'The half in front of the camera, square'"
complete -c mariana -n "__fish_mariana_using_subcommand still" -l stereo -d 'Pictures for two eyes' -r -f -a "none\t''
side-by-side\t'The left eye on the left'
over-under\t'The left eye above'"
complete -c mariana -n "__fish_mariana_using_subcommand still" -l eye-distance -d 'Distance of the eyes in the scene\'s units; larger distances make the scene look smaller' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -l dome-tilt -d 'Height of the camera\'s target in a dome, in degrees above the front rim; 90 is the zenith [default: 45]' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -l shutter -d 'Motion blur: the part of a frame\'s time during which the shutter is open, in degrees, such as 180; 0 for none' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -l shutter-frames -d 'Exposures of each frame with --shutter; drawing takes this many times as long' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -l light -d 'Computation of light' -r -f -a "raster\t'as in the window'
path\t'paths of light: exact shadows, reflections and indirect light, but slow'"
complete -c mariana -n "__fish_mariana_using_subcommand still" -l samples -d 'With --light path: most paths of a pixel [default: 256]' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -l noise -d 'With --light path: stop where the light\'s relative error is below this; 0 for all paths [default: 0.03]' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -s o -l output -d 'The PNG, JPEG or WebP file to write, or \'-\' for a PNG on standard output' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand still" -l scene -d 'The scene to show: a file, the name of a shipped scene (\'mariana scenes\' lists them), or a formula such as "length(p) - 1" [default: speakers]' -r -a "barth cathedral city clockwork cloud_sea fireflies first_steps forest glass_organ gyroid heart ink kaleidoscope lattice lava_lamp letters library mandelbulb marbling metaballs moonrise nave orb quadric rain reef speakers spiral terrain tunnel village wave_tank wax_world"
complete -c mariana -n "__fish_mariana_using_subcommand still" -l show -d 'Show this moment of a show instead of a scene: \'auto\' for a show that follows the song, or a .show file' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -l into -d 'Show a blend of the scene with this second scene' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -l blend -d 'Kind of blend, and the fraction of the second scene from 0 to 1: melt, where every surface flows from one scene to the other; ball, where the other scene is inside a growing ball; plane, where the other scene is behind a moving plane; shape, where the other scene is inside a shape that it names' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -l ray -d 'Draw the path of the ray through this pixel over the image, with sections that show its steps, its shadow ray and its occlusion; 0,0 is the upper left pixel' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -l set -d 'Hold an input at a value, such as "volume.x=0.3", "band(3)=0.5" or a param of the scene; can be given more than once' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -l view -d 'Show a view of the rendering process, with a legend: - steps: steps of the ray from the eye, blue to red; steps:NUMBER sets the count shown in red, 100 by default - slice: the distance on a plane through the camera\'s target, as lines; slice:NUMBER sets the distance between two lines - normals: normals of the surfaces, by finite differences of the distance; normals:NUMBER sets the step of the differences, by default a fraction of a pixel - shadow: the fraction of direct light that arrives - occlusion: the fraction of the ambient light that arrives - clauses: clauses that the interpreter runs; distance evaluations if compiled; clauses:NUMBER sets the count shown in red - cells: the cells of the regions, and the lengths of their tapes - materials: a colour for each object - depth: the distance to the surface; depth:NUMBER sets the distance shown in black ' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -l sdf -d 'Interpret or compile the scene\'s formulas; auto interprets at once and compiles in the background' -r -f -a "interpreted\t''
compiled\t''
auto\t''"
complete -c mariana -n "__fish_mariana_using_subcommand still" -l regions -d 'Skip empty space with a tree of cells and run a shortened tape in each cell; the image is the same [default: on where that is faster; bench measures both]' -r -f -a "on\t''
off\t''"
complete -c mariana -n "__fish_mariana_using_subcommand still" -l tone-map -d 'Conversion of light to screen colours [default: the scene\'s own, or in a window the last choice there]' -r -f -a "scene\t'The scene\'s own choice'
agx\t'Natural colours; bright colours fade to white, as on film'
aces\t'Deep shadows and vivid colours'
reinhard\t'Gentle highlights'
none\t'Light as it is; all that is too bright becomes white'"
complete -c mariana -n "__fish_mariana_using_subcommand still" -l gain -d 'Automatic gain: quiet and loud songs move the image by the same amount; values in decibels are never changed [default: auto, or in a window the last choice there]' -r -f -a "auto\t''
off\t''"
complete -c mariana -n "__fish_mariana_using_subcommand still" -l shaders -d 'Read the shaders from this folder, to work on them' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand still" -l no-filter -d 'With --light path: leave the noise that is left, instead of smoothing it'
complete -c mariana -n "__fish_mariana_using_subcommand still" -l alpha -d 'Leave out the sky, so that the image can be laid over another: in PNG and WebP, for scenes whose sky has no color'
complete -c mariana -n "__fish_mariana_using_subcommand still" -l controlled -d 'Draw a thumbnail for a window of Mariana, at the lowest priority, and end when standard input ends'
complete -c mariana -n "__fish_mariana_using_subcommand still" -s v -l verbose -d 'Log what the program does; twice for more'
complete -c mariana -n "__fish_mariana_using_subcommand still" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c mariana -n "__fish_mariana_using_subcommand video" -l for -d 'Use the size, rate and length of a service; other flags override them' -r -f -a "youtube\t'1920x1080 at 60 frames a second'
4k\t'3840x2160 at 30 frames a second'
shorts\t'Portrait, 1080x1920 at 30 frames a second, the first 180 seconds'
tiktok\t'Portrait, 1080x1920 at 30 frames a second'
reel\t'Portrait, 1080x1920 at 30 frames a second, the first 90 seconds'
story\t'Portrait, 1080x1920 at 30 frames a second, the first 60 seconds'
square\t'1080x1080 at 30 frames a second'
loop\t'Portrait, 1080x1920 at 30 frames a second; 8 seconds without sound whose end fades into the beginning'"
complete -c mariana -n "__fish_mariana_using_subcommand video" -l start -d 'Start, as 80 or 1:20.5' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -l duration -d 'Length, as 80 or 1:20.5 [default: to the end, or set by --for]' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -l fps -d 'Frames per second, such as 60, 23.976 or 30000/1001 [default: 30, or set by --for]' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -l size -d 'Size of the whole picture in pixels, with both eyes of --stereo [default: 1280x720, or set by --for, --projection and --stereo]' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -l projection -d 'Projection: for players of 360-degree videos, planetariums and headsets' -r -f -a "flat\t''
360\t'The whole sphere, twice as wide as high'
dome\t'A square dome master: a disc of 180 degrees'
vr180\t'The half in front of the camera, square'"
complete -c mariana -n "__fish_mariana_using_subcommand video" -l stereo -d 'Pictures for two eyes' -r -f -a "none\t''
side-by-side\t'The left eye on the left'
over-under\t'The left eye above'"
complete -c mariana -n "__fish_mariana_using_subcommand video" -l eye-distance -d 'Distance of the eyes in the scene\'s units; larger distances make the scene look smaller' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -l dome-tilt -d 'Height of the camera\'s target in a dome, in degrees above the front rim; 90 is the zenith [default: 45]' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -l shutter -d 'Motion blur: the part of a frame\'s time during which the shutter is open, in degrees, such as 180; 0 for none' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -l shutter-frames -d 'Exposures of each frame with --shutter; drawing takes this many times as long' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -l light -d 'Computation of light' -r -f -a "raster\t'as in the window'
path\t'paths of light: exact shadows, reflections and indirect light, but slow'"
complete -c mariana -n "__fish_mariana_using_subcommand video" -l samples -d 'With --light path: most paths of a pixel [default: 256]' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -l noise -d 'With --light path: stop where the light\'s relative error is below this; 0 for all paths [default: 0.03]' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -l codec -d 'Video codec [default: chosen by the extension of the file\'s name]' -r -f -a "h264\t'Plays everywhere'
h265\t'Half the bytes of h264'
vp9\t'For webm'
av1\t'The smallest files, and the slowest encoding'"
complete -c mariana -n "__fish_mariana_using_subcommand video" -l quality -d 'Quality of the encoding' -r -f -a "low\t'A small preview'
medium\t''
high\t'Differences are hardly visible'
best\t'For services that encode the video again'"
complete -c mariana -n "__fish_mariana_using_subcommand video" -l lyrics -d 'Show the lyrics while they are sung: from FILE, or from song.lrc or the tags of the song' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand video" -l flash-limiter -d 'Dim flashes if there are more than three a second, as WCAG 2.3.1 requires' -r -f -a "on\t''
off\t''"
complete -c mariana -n "__fish_mariana_using_subcommand video" -l scene -d 'The scene to show, as for \'still\'; give several with the time in the song at which each begins, such as --scene orb --scene city@1:20 [default: speakers]' -r -a "barth cathedral city clockwork cloud_sea fireflies first_steps forest glass_organ gyroid heart ink kaleidoscope lattice lava_lamp letters library mandelbulb marbling metaballs moonrise nave orb quadric rain reef speakers spiral terrain tunnel village wave_tank wax_world"
complete -c mariana -n "__fish_mariana_using_subcommand video" -l show -d 'A show instead of scenes: \'auto\' for a show that follows the song with the scenes of --scene, or with all shipped scenes; \'demo\' for the demo track\'s show; or a .show file' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -l set -d 'Hold an input at a value, such as "volume.x=0.3", "band(3)=0.5" or a param of the scene; can be given more than once' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -s o -l output -d 'The video to write (mp4, mkv, mov, webm, or gif and webp without sound), a folder ending in \'/\' for numbered PNGs, or \'-\' for y4m without sound on standard output' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand video" -l part -d 'Render one part of the video, such as 3/8, without sound: for several machines. Continues an interrupted part' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -l join -d 'Join parts into the video without encoding again, and add the sound of FILE' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand video" -l view -d 'Show a view of the rendering process, with a legend: - steps: steps of the ray from the eye, blue to red; steps:NUMBER sets the count shown in red, 100 by default - slice: the distance on a plane through the camera\'s target, as lines; slice:NUMBER sets the distance between two lines - normals: normals of the surfaces, by finite differences of the distance; normals:NUMBER sets the step of the differences, by default a fraction of a pixel - shadow: the fraction of direct light that arrives - occlusion: the fraction of the ambient light that arrives - clauses: clauses that the interpreter runs; distance evaluations if compiled; clauses:NUMBER sets the count shown in red - cells: the cells of the regions, and the lengths of their tapes - materials: a colour for each object - depth: the distance to the surface; depth:NUMBER sets the distance shown in black ' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -l sdf -d 'Interpret or compile the scene\'s formulas; auto interprets at once and compiles in the background' -r -f -a "interpreted\t''
compiled\t''
auto\t''"
complete -c mariana -n "__fish_mariana_using_subcommand video" -l regions -d 'Skip empty space with a tree of cells and run a shortened tape in each cell; the image is the same [default: on where that is faster; bench measures both]' -r -f -a "on\t''
off\t''"
complete -c mariana -n "__fish_mariana_using_subcommand video" -l tone-map -d 'Conversion of light to screen colours [default: the scene\'s own, or in a window the last choice there]' -r -f -a "scene\t'The scene\'s own choice'
agx\t'Natural colours; bright colours fade to white, as on film'
aces\t'Deep shadows and vivid colours'
reinhard\t'Gentle highlights'
none\t'Light as it is; all that is too bright becomes white'"
complete -c mariana -n "__fish_mariana_using_subcommand video" -l gain -d 'Automatic gain: quiet and loud songs move the image by the same amount; values in decibels are never changed [default: auto, or in a window the last choice there]' -r -f -a "auto\t''
off\t''"
complete -c mariana -n "__fish_mariana_using_subcommand video" -l shaders -d 'Read the shaders from this folder, to work on them' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand video" -l no-filter -d 'With --light path: leave the noise that is left, instead of smoothing it'
complete -c mariana -n "__fish_mariana_using_subcommand video" -l draft -d 'Draw faster, with coarser edges, for a first look'
complete -c mariana -n "__fish_mariana_using_subcommand video" -l title-card -d 'Show the song\'s title and artist during the first five seconds, or less in a short video'
complete -c mariana -n "__fish_mariana_using_subcommand video" -l alpha -d 'Leave out the sky, so that the video can be laid over another video: in webm, mov, mkv, webp and PNGs, for scenes whose sky has no color'
complete -c mariana -n "__fish_mariana_using_subcommand video" -s q -l quiet -d 'Print only errors'
complete -c mariana -n "__fish_mariana_using_subcommand video" -l controlled -d 'Render for a window of Mariana, at a low priority: print reports as JSON on standard output, obey the lines \'pause\' and \'continue\' on standard input, end when standard input ends, and never replace a file'
complete -c mariana -n "__fish_mariana_using_subcommand video" -s v -l verbose -d 'Log what the program does; twice for more'
complete -c mariana -n "__fish_mariana_using_subcommand video" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c mariana -n "__fish_mariana_using_subcommand analyze" -l plot -d 'Draw the song on one page: waveform, energy, beats, bars, sections, builds, drops, chords, chroma, and the director\'s show' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand analyze" -l gain -d 'Automatic gain: quiet and loud songs reach the same values from 0 to 1' -r -f -a "auto\t''
off\t''"
complete -c mariana -n "__fish_mariana_using_subcommand analyze" -l fps -d 'Lines per second' -r
complete -c mariana -n "__fish_mariana_using_subcommand analyze" -l start -d 'Start, as 80 or 1:20.5' -r
complete -c mariana -n "__fish_mariana_using_subcommand analyze" -l duration -d 'Length, as 80 or 1:20.5 [default: to the end]' -r
complete -c mariana -n "__fish_mariana_using_subcommand analyze" -l structure -d 'Print the structure of the whole song instead of its moments: tempo, bars, key, sections, builds, drops'
complete -c mariana -n "__fish_mariana_using_subcommand analyze" -l song -d 'Also print the position in the whole song at each moment: bar, section, energy, build, drop, ...'
complete -c mariana -n "__fish_mariana_using_subcommand analyze" -l json -d 'Print one JSON object per line: t, volume as [left, right], bands as 32 numbers, ...; with --structure a single object'
complete -c mariana -n "__fish_mariana_using_subcommand analyze" -s h -l help -d 'Print help'
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l at -d 'The moment of the song to draw, as 80 or 1:20.5' -r
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l size -d 'Size in pixels' -r
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l frames -d 'Frames to time' -r
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l only -d 'With --all: measure only scenes whose names contain this text; can be given more than once' -r
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l scene -d 'The scene to show: a file, the name of a shipped scene (\'mariana scenes\' lists them), or a formula such as "length(p) - 1" [default: speakers]' -r -a "barth cathedral city clockwork cloud_sea fireflies first_steps forest glass_organ gyroid heart ink kaleidoscope lattice lava_lamp letters library mandelbulb marbling metaballs moonrise nave orb quadric rain reef speakers spiral terrain tunnel village wave_tank wax_world"
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l sdf -d 'Interpret or compile the scene\'s formulas; auto interprets at once and compiles in the background' -r -f -a "interpreted\t''
compiled\t''
auto\t''"
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l regions -d 'Skip empty space with a tree of cells and run a shortened tape in each cell; the image is the same [default: on where that is faster; bench measures both]' -r -f -a "on\t''
off\t''"
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l tone-map -d 'Conversion of light to screen colours [default: the scene\'s own, or in a window the last choice there]' -r -f -a "scene\t'The scene\'s own choice'
agx\t'Natural colours; bright colours fade to white, as on film'
aces\t'Deep shadows and vivid colours'
reinhard\t'Gentle highlights'
none\t'Light as it is; all that is too bright becomes white'"
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l gain -d 'Automatic gain: quiet and loud songs move the image by the same amount; values in decibels are never changed [default: auto, or in a window the last choice there]' -r -f -a "auto\t''
off\t''"
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l shaders -d 'Read the shaders from this folder, to work on them' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l all -d 'Measure all shipped scenes'
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l edges -d 'Also measure time and quality for each number of samples at edges, at several sizes, which is slow'
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l json -d 'Print JSON instead of text'
complete -c mariana -n "__fish_mariana_using_subcommand bench" -s v -l verbose -d 'Log what the program does; twice for more'
complete -c mariana -n "__fish_mariana_using_subcommand bench" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c mariana -n "__fish_mariana_using_subcommand check" -l json -d 'Print one JSON object per line and mistake: file, line, column, end, severity, message, hint'
complete -c mariana -n "__fish_mariana_using_subcommand check" -s h -l help -d 'Print help'
complete -c mariana -n "__fish_mariana_using_subcommand format" -l check -d 'Change nothing: print the names of the files that would change, and fail if there are any'
complete -c mariana -n "__fish_mariana_using_subcommand format" -s h -l help -d 'Print help'
complete -c mariana -n "__fish_mariana_using_subcommand lsp" -l stdio -d 'Use standard input and output, as always; editors add this flag out of habit'
complete -c mariana -n "__fish_mariana_using_subcommand lsp" -s h -l help -d 'Print help'
complete -c mariana -n "__fish_mariana_using_subcommand tape" -l at -d 'Print the short tape of the cell around this point, with the bounds of each clause' -r
complete -c mariana -n "__fish_mariana_using_subcommand tape" -l glsl -d 'Print the distance as GLSL instead'
complete -c mariana -n "__fish_mariana_using_subcommand tape" -l dot -d 'Print the expression graph in Graphviz\'s DOT language instead'
complete -c mariana -n "__fish_mariana_using_subcommand tape" -s h -l help -d 'Print help'
complete -c mariana -n "__fish_mariana_using_subcommand eval" -l at -d 'A point at which to evaluate; can be given more than once' -r
complete -c mariana -n "__fish_mariana_using_subcommand eval" -l points -d 'A file with one point per line: x,y,z; \'-\' is standard input' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand eval" -l set -d 'Hold an input at a value, such as "volume.x=0.3", "band(3)=0.5" or a param of the scene; can be given more than once' -r
complete -c mariana -n "__fish_mariana_using_subcommand eval" -s h -l help -d 'Print help'
complete -c mariana -n "__fish_mariana_using_subcommand import" -s o -l output -d 'The scene to write, which must not exist yet; a GLSL file in another folder is copied to its folder. \'-\' prints the scene [default: the name of the GLSL file with the ending .scene]' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand import" -l as -d 'What to show of a shader that draws a picture and has a distance function: its own picture, or the distance as an object in the light of a scene' -r -f -a "picture\t''
shape\t''"
complete -c mariana -n "__fish_mariana_using_subcommand import" -s h -l help -d 'Print help'
complete -c mariana -n "__fish_mariana_using_subcommand export" -s o -l output -d 'The file to write; only an earlier export is replaced; \'-\' is standard output' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand export" -l glsl -d 'Write GLSL; this is the only format so far'
complete -c mariana -n "__fish_mariana_using_subcommand export" -l main-image -d 'Add a mainImage that draws the scene in Shadertoy'
complete -c mariana -n "__fish_mariana_using_subcommand export" -s h -l help -d 'Print help'
complete -c mariana -n "__fish_mariana_using_subcommand show" -l scene -d 'A scene from which to choose; can be given more than once [default: all shipped scenes]' -r -a "barth cathedral city clockwork cloud_sea fireflies first_steps forest glass_organ gyroid heart ink kaleidoscope lattice lava_lamp letters library mandelbulb marbling metaballs moonrise nave orb quadric rain reef speakers spiral terrain tunnel village wave_tank wax_world"
complete -c mariana -n "__fish_mariana_using_subcommand show" -s o -l output -d 'The show file to write; \'-\' is standard output' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand show" -s h -l help -d 'Print help'
complete -c mariana -n "__fish_mariana_using_subcommand mesh" -l at -d 'The moment in the song, as 80 or 1:20.5' -r
complete -c mariana -n "__fish_mariana_using_subcommand mesh" -l detail -d 'The number of cells along the longest side: twice as many give four times as many triangles' -r
complete -c mariana -n "__fish_mariana_using_subcommand mesh" -l scene -d 'The scene to show: a file, the name of a shipped scene (\'mariana scenes\' lists them), or a formula such as "length(p) - 1" [default: speakers]' -r -a "barth cathedral city clockwork cloud_sea fireflies first_steps forest glass_organ gyroid heart ink kaleidoscope lattice lava_lamp letters library mandelbulb marbling metaballs moonrise nave orb quadric rain reef speakers spiral terrain tunnel village wave_tank wax_world"
complete -c mariana -n "__fish_mariana_using_subcommand mesh" -l set -d 'Hold an input at a value, such as "volume.x=0.3", "band(3)=0.5" or a param of the scene; can be given more than once' -r
complete -c mariana -n "__fish_mariana_using_subcommand mesh" -s o -l output -d 'The file to write: .glb with colours, for Blender and others; .stl, for printing; or .obj' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand mesh" -l sdf -d 'Interpret or compile the scene\'s formulas; auto interprets at once and compiles in the background' -r -f -a "interpreted\t''
compiled\t''
auto\t''"
complete -c mariana -n "__fish_mariana_using_subcommand mesh" -l regions -d 'Skip empty space with a tree of cells and run a shortened tape in each cell; the image is the same [default: on where that is faster; bench measures both]' -r -f -a "on\t''
off\t''"
complete -c mariana -n "__fish_mariana_using_subcommand mesh" -l tone-map -d 'Conversion of light to screen colours [default: the scene\'s own, or in a window the last choice there]' -r -f -a "scene\t'The scene\'s own choice'
agx\t'Natural colours; bright colours fade to white, as on film'
aces\t'Deep shadows and vivid colours'
reinhard\t'Gentle highlights'
none\t'Light as it is; all that is too bright becomes white'"
complete -c mariana -n "__fish_mariana_using_subcommand mesh" -l gain -d 'Automatic gain: quiet and loud songs move the image by the same amount; values in decibels are never changed [default: auto, or in a window the last choice there]' -r -f -a "auto\t''
off\t''"
complete -c mariana -n "__fish_mariana_using_subcommand mesh" -l shaders -d 'Read the shaders from this folder, to work on them' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand mesh" -s v -l verbose -d 'Log what the program does; twice for more'
complete -c mariana -n "__fish_mariana_using_subcommand mesh" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c mariana -n "__fish_mariana_using_subcommand page" -s o -l output -d 'The page to write; it opens without a server' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand page" -l template -d 'The page without a song that \'scripts/site\' builds [default: the installed one, or the one in target/site]' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand page" -l scene -d 'The scene to show: a file, the name of a shipped scene (\'mariana scenes\' lists them), or a formula such as "length(p) - 1" [default: speakers]' -r -a "barth cathedral city clockwork cloud_sea fireflies first_steps forest glass_organ gyroid heart ink kaleidoscope lattice lava_lamp letters library mandelbulb marbling metaballs moonrise nave orb quadric rain reef speakers spiral terrain tunnel village wave_tank wax_world"
complete -c mariana -n "__fish_mariana_using_subcommand page" -l show -d 'A show instead of one scene: \'auto\' for a show that follows the song, \'demo\' for the demo track\'s show, a .show file, or \'off\' [default: auto, unless a scene is given]' -r
complete -c mariana -n "__fish_mariana_using_subcommand page" -l sdf -d 'Interpret or compile the scene\'s formulas; auto interprets at once and compiles in the background' -r -f -a "interpreted\t''
compiled\t''
auto\t''"
complete -c mariana -n "__fish_mariana_using_subcommand page" -l regions -d 'Skip empty space with a tree of cells and run a shortened tape in each cell; the image is the same [default: on where that is faster; bench measures both]' -r -f -a "on\t''
off\t''"
complete -c mariana -n "__fish_mariana_using_subcommand page" -l tone-map -d 'Conversion of light to screen colours [default: the scene\'s own, or in a window the last choice there]' -r -f -a "scene\t'The scene\'s own choice'
agx\t'Natural colours; bright colours fade to white, as on film'
aces\t'Deep shadows and vivid colours'
reinhard\t'Gentle highlights'
none\t'Light as it is; all that is too bright becomes white'"
complete -c mariana -n "__fish_mariana_using_subcommand page" -l gain -d 'Automatic gain: quiet and loud songs move the image by the same amount; values in decibels are never changed [default: auto, or in a window the last choice there]' -r -f -a "auto\t''
off\t''"
complete -c mariana -n "__fish_mariana_using_subcommand page" -l shaders -d 'Read the shaders from this folder, to work on them' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand page" -l loop -d 'Begin the song again at its end'
complete -c mariana -n "__fish_mariana_using_subcommand page" -l embed -d 'Leave out the buttons and keys for scenes, sliders and texts, for a frame in another page'
complete -c mariana -n "__fish_mariana_using_subcommand page" -s v -l verbose -d 'Log what the program does; twice for more'
complete -c mariana -n "__fish_mariana_using_subcommand page" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c mariana -n "__fish_mariana_using_subcommand scenes" -s h -l help -d 'Print help'
complete -c mariana -n "__fish_mariana_using_subcommand devices" -l json -d 'Print JSON instead of text'
complete -c mariana -n "__fish_mariana_using_subcommand devices" -s h -l help -d 'Print help'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check format lsp tape eval import export show mesh page scenes devices help" -f -a "still" -d 'Render one moment of a song to a PNG, JPEG or WebP, without a window or a sound card'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check format lsp tape eval import export show mesh page scenes devices help" -f -a "video" -d 'Render a part of a song to a video (needs ffmpeg) or to numbered stills'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check format lsp tape eval import export show mesh page scenes devices help" -f -a "analyze" -d 'Print the features of a song, one line for each frame'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check format lsp tape eval import export show mesh page scenes devices help" -f -a "bench" -d 'Measure frame times and distance evaluations, without a window'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check format lsp tape eval import export show mesh page scenes devices help" -f -a "check" -d 'Check scenes: print each mistake with its position, or the cost of the scene'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check format lsp tape eval import export show mesh page scenes devices help" -f -a "format" -d 'Format scene files; the scenes stay the same'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check format lsp tape eval import export show mesh page scenes devices help" -f -a "lsp" -d 'Run the language server for editors, on standard input and output'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check format lsp tape eval import export show mesh page scenes devices help" -f -a "tape" -d 'Print the tape of a scene\'s distance: the clauses that the interpreter runs'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check format lsp tape eval import export show mesh page scenes devices help" -f -a "eval" -d 'Evaluate a scene\'s distance at points, one number per line'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check format lsp tape eval import export show mesh page scenes devices help" -f -a "import" -d 'Make a scene from a shader in GLSL, such as one from Shadertoy'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check format lsp tape eval import export show mesh page scenes devices help" -f -a "export" -d 'Write a scene\'s distance and colours as GLSL, for example for Shadertoy'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check format lsp tape eval import export show mesh page scenes devices help" -f -a "show" -d 'Write the director\'s show for a song to a show file, for editing'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check format lsp tape eval import export show mesh page scenes devices help" -f -a "mesh" -d 'Write the surfaces of a moment as triangles, for Blender and for printing'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check format lsp tape eval import export show mesh page scenes devices help" -f -a "page" -d 'Write a web page that plays a song with a show or a scene, in one file'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check format lsp tape eval import export show mesh page scenes devices help" -f -a "scenes" -d 'List the shipped scenes with their descriptions'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check format lsp tape eval import export show mesh page scenes devices help" -f -a "devices" -d 'List the sound systems with their inputs and outputs, and the formats of these devices'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check format lsp tape eval import export show mesh page scenes devices help" -f -a "help" -d 'Print this message or the help of the given subcommand(s)'
