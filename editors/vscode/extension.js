"use strict";

// The client of `rtamt lsp`: it starts the server, gives it the settings, and lets the user choose a recording.

const path = require("node:path");
const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

function settings() {
  const all = vscode.workspace.getConfiguration("rtamt");
  return Object.fromEntries(["recording", "period", "time", "documentation"].map((name) => [name, all.get(name)]));
}

async function start() {
  const [command, ...args] = vscode.workspace.getConfiguration("rtamt").get("command");
  client = new LanguageClient(
    "rtamt",
    "rtamt",
    { command, args },
    {
      documentSelector: [{ language: "stl" }],
      initializationOptions: settings(),
    },
  );
  try {
    await client.start();
  } catch (error) {
    client = undefined;
    vscode.window.showErrorMessage(
      `The language server '${command}' does not start: ${error.message}. ` +
        "Install it with pip install 'rtamt[lsp]', or set rtamt.command.",
    );
  }
}

async function stop() {
  const running = client;
  client = undefined;
  await running?.stop();
}

async function chooseRecording() {
  const edited = vscode.window.activeTextEditor?.document.uri;
  const chosen = await vscode.window.showOpenDialog({
    canSelectMany: false,
    defaultUri: edited?.scheme === "file" ? vscode.Uri.joinPath(edited, "..") : undefined,
    openLabel: "Check on this recording",
    title: "The recording on which requirements are checked",
  });
  if (chosen === undefined) {
    return;
  }
  const file = chosen[0];
  const folder = vscode.workspace.getWorkspaceFolder(file);
  const name = folder === undefined ? file.fsPath : path.relative(folder.uri.fsPath, file.fsPath);
  const target = vscode.workspace.workspaceFolders
    ? vscode.ConfigurationTarget.Workspace
    : vscode.ConfigurationTarget.Global;
  await vscode.workspace.getConfiguration("rtamt").update("recording", name, target);
}

async function activate(context) {
  context.subscriptions.push(
    vscode.commands.registerCommand("rtamt.chooseRecording", chooseRecording),
    vscode.commands.registerCommand("rtamt.restart", async () => {
      await stop();
      await start();
    }),
    vscode.workspace.onDidChangeConfiguration(async (change) => {
      if (change.affectsConfiguration("rtamt.command")) {
        await stop();
        await start();
      } else if (change.affectsConfiguration("rtamt")) {
        await client?.sendNotification("workspace/didChangeConfiguration", { settings: { rtamt: settings() } });
      }
    }),
  );
  await start();
}

module.exports = { activate, deactivate: stop };
