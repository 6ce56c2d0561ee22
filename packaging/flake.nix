# Builds Mariana with Nix: nix run "github:OWNER/REPOSITORY?dir=packaging". Version and crates come from Cargo.toml and
# Cargo.lock, so nothing here changes with a release.
{
  description = "Mariana, a music visualizer whose worlds are formulas";
  inputs.nixpkgs.url = "github:NixOS/nixpkgs/nixos-unstable";

  outputs = { self, nixpkgs }:
    let
      systems = [ "x86_64-linux" "aarch64-linux" ];
      forEach = f: nixpkgs.lib.genAttrs systems (system: f nixpkgs.legacyPackages.${system});
      manifest = builtins.fromTOML (builtins.readFile ../Cargo.toml);
      facts = manifest.workspace.package;
    in
    {
      packages = forEach (pkgs:
        let
          # The libraries that the program loads while it runs.
          loaded = with pkgs; [
            libGL
            libxkbcommon
            wayland
            xorg.libX11
            xorg.libXcursor
            xorg.libXi
            xorg.libxcb
          ];
        in
        {
          default = pkgs.rustPlatform.buildRustPackage {
            pname = "mariana";
            version = facts.version;
            src = ../.;
            cargoLock.lockFile = ../Cargo.lock;
            buildAndTestSubdir = ".";
            buildType = "download";
            nativeBuildInputs = with pkgs; [ cmake makeWrapper pkg-config ];
            buildInputs = [ pkgs.alsa-lib ];
            # cmake is for a crate, not for the program. The tests need a desktop, a sound server and a browser.
            dontUseCmakeConfigure = true;
            doCheck = false;
            installPhase = ''
              runHook preInstall
              bash scripts/install --prefix "$out" --binary "$(find target -name mariana -path '*download/mariana')"
              wrapProgram "$out/bin/mariana" \
                --prefix LD_LIBRARY_PATH : ${pkgs.lib.makeLibraryPath loaded} \
                --prefix PATH : ${pkgs.lib.makeBinPath [ pkgs.ffmpeg-headless ]}
              runHook postInstall
            '';
            meta = {
              description = manifest.package.description;
              homepage = facts.homepage;
              license = with pkgs.lib.licenses; [ mit asl20 ];
              mainProgram = "mariana";
              platforms = systems;
            };
          };
        });
    };
}
