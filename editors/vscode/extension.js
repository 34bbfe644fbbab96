// Starts `palmistry lsp` for proof files.
const { workspace } = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

exports.activate = () => {
  const command = workspace.getConfiguration("palmistry").get("program", "palmistry");
  client = new LanguageClient("palmistry", "Palmistry", { command, args: ["lsp"] }, {
    documentSelector: [{ language: "palmistry" }],
  });
  return client.start();
};

exports.deactivate = () => client?.stop();
